//! Connected components of a mesh. Each plate is one component.

/// Component number of each node; components are numbered in the order of their first nodes.
#[derive(Clone, Default)]
pub struct Components {
    of_node: Vec<usize>,
    count: usize,
}

impl Components {
    /// Makes the components of a mesh with `nodes` nodes. Each of `connected` is a list of nodes that are connected
    /// with each other.
    pub fn new<'a>(nodes: usize, connected: impl Iterator<Item = &'a [usize]>) -> Self {
        // Union–find: `before` has an earlier node of the same component, or the node itself if it is the first. Each
        // chain ends at the first node of its component.
        let mut before: Vec<usize> = (0..nodes).collect();
        let first_of = |before: &mut [usize], mut node: usize| {
            while before[node] != node {
                before[node] = before[before[node]];
                node = before[node];
            }
            node
        };
        for pair in connected.flat_map(|set| set.windows(2)) {
            let [one, other] = [pair[0], pair[1]].map(|node| first_of(&mut before, node));
            before[one.max(other)] = one.min(other);
        }
        let mut components = Self { of_node: Vec::with_capacity(nodes), count: 0 };
        for (node, &before) in before.iter().enumerate() {
            let number = if before == node { components.count } else { components.of_node[before] };
            components.count = components.count.max(number + 1);
            components.of_node.push(number);
        }
        components
    }

    pub fn of(&self, node: usize) -> usize {
        self.of_node[node]
    }

    pub fn count(&self) -> usize {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_that_overlap_are_of_one_component() {
        let sets: [&[usize]; 4] = [&[6, 4], &[1, 5, 3], &[4, 2], &[3, 6]];
        let found = |sets: &[&[usize]]| {
            let components = Components::new(7, sets.iter().copied());
            ((0..7).map(|node| components.of(node)).collect::<Vec<_>>(), components.count())
        };
        assert_eq!(found(&sets), (vec![0, 1, 1, 1, 1, 1, 1], 2));
        assert_eq!(found(&sets[..3]), (vec![0, 1, 2, 1, 2, 1, 2], 3));
    }
}
