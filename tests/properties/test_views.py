"""Meshes and results depend on no unit, place, sense or order of the axes."""

import views
from hypothesis import assume, given, settings
from hypothesis import strategies as st

seeds = st.integers(0, 10**6)


@settings(max_examples=8)
@given(seed=seeds, name=st.sampled_from(sorted(views.VIEWS)))
def test_a_plate_has_the_same_mesh_in_other_units_elsewhere_mirrored_and_turned(seed, name):
    assume(views.refused(seed) is not None)
    assert views.differing(seed, name, solved=False) == []


@settings(max_examples=3)
@given(seed=seeds, name=st.sampled_from(["feet", "millimetres", "thousandths", "halves", "moved"]))
def test_reactions_extremes_and_contact_do_not_depend_on_units_and_place(seed, name):
    assume(views.refused(seed) is not None)
    assert views.differing(seed, name, solved=True) == []
