"""Where a plate's numbers have no limit as the mesh is refined, known before it is solved."""
