//! The declarations of tasks that extend each other, merged row by row: a declaration of an extending task replaces what has the
//! same name in the tasks that it extends, where the first of those stands; the rest is added behind; `remove` takes out.
//!
//! Statements of tasks (`inherit`), scenes (`scene::expand`) and initial states (`init::layers`) are merged by it.

use std::collections::BTreeMap;

/// A row, and which task of a line of extended ones declares it: 0 is the oldest.
#[derive(Debug, Clone)]
struct Row<K, T> {
    key: K,
    layer: usize,
    item: T,
}

/// Rows in their order, found by their keys.
#[derive(Debug, Clone)]
pub(crate) struct Layers<K, T> {
    /// `None` where a row was taken out.
    rows: Vec<Option<Row<K, T>>>,
    /// Where the rows of each key stand, in their order.
    places: BTreeMap<K, Vec<usize>>,
    /// Those that were not taken out.
    count: usize,
}

impl<K, T> Default for Layers<K, T> {
    fn default() -> Self {
        Self { rows: Vec::new(), places: BTreeMap::new(), count: 0 }
    }
}

impl<K: Ord + Clone, T> Layers<K, T> {
    /// Adds a row behind all others, whatever has the same key.
    pub(crate) fn add(&mut self, key: K, layer: usize, item: T) {
        self.places.entry(key.clone()).or_default().push(self.rows.len());
        self.rows.push(Some(Row { key, layer, item }));
        self.count += 1;
    }

    /// Puts a row in the place of those that older layers have under its key, or adds it behind.
    pub(crate) fn lay(&mut self, key: K, layer: usize, item: T) {
        let Self { rows, places, count } = self;
        let known = places.get_mut(&key);
        let older = |place: &usize| rows.get(*place).and_then(Option::as_ref).is_some_and(|row| row.layer < layer);
        let Some((known, first)) =
            known.and_then(|known| known.iter().copied().find(|place| older(place)).map(|first| (known, first)))
        else {
            return self.add(key, layer, item);
        };
        let (gone, stay): (Vec<usize>, Vec<usize>) = known.iter().copied().partition(|place| older(place));
        *count -= gone.len() - 1;
        gone.into_iter().for_each(|place| rows[place] = None);
        *known = stay;
        known.push(first);
        known.sort_unstable();
        rows[first] = Some(Row { key, layer, item });
    }

    /// The first row of a key.
    pub(crate) fn first(&mut self, key: &K) -> Option<&mut T> {
        let place = self.places.get(key)?.first()?;
        self.rows.get_mut(*place)?.as_mut().map(|row| &mut row.item)
    }

    /// Takes out all rows of a key; gives whether there was any.
    pub(crate) fn take_out(&mut self, key: &K) -> bool {
        let places = self.places.remove(key).unwrap_or_default();
        places.iter().for_each(|place| self.rows[*place] = None);
        self.count -= places.len();
        !places.is_empty()
    }

    /// Takes out all rows whose key and layer are wanted; gives whether there was any.
    pub(crate) fn take_out_where(&mut self, wanted: impl Fn(&K, usize) -> bool) -> bool {
        let mut any = false;
        for (place, slot) in self.rows.iter_mut().enumerate() {
            if let Some(row) = slot.take_if(|row| wanted(&row.key, row.layer)) {
                any = true;
                self.count -= 1;
                if let Some(places) = self.places.get_mut(&row.key) {
                    places.retain(|known| *known != place);
                }
            }
        }
        any
    }

    /// How many rows there are.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The keys and layers of all rows, in their order.
    pub(crate) fn keys(&self) -> impl Iterator<Item = (&K, usize)> + Clone {
        self.rows.iter().flatten().map(|row| (&row.key, row.layer))
    }

    /// All rows, in their order.
    pub(crate) fn into_items(self) -> impl Iterator<Item = T> {
        self.rows.into_iter().flatten().map(|row| row.item)
    }
}

#[cfg(test)]
mod tests {
    use super::Layers;

    fn items(layers: Layers<&str, u32>) -> Vec<u32> {
        layers.into_items().collect()
    }

    #[test]
    fn a_row_takes_the_place_of_all_that_older_layers_have_under_its_key() {
        let mut layers = Layers::default();
        for (key, layer, item) in [("a", 0, 1), ("b", 0, 2), ("a", 0, 3), ("c", 0, 4), ("a", 1, 5), ("a", 1, 6), ("b", 2, 7)] {
            layers.lay(key, layer, item);
        }
        assert_eq!(layers.count(), 4);
        assert_eq!(items(layers), [5, 7, 4, 6]);
    }

    #[test]
    fn what_is_taken_out_is_gone_and_may_come_again() {
        let mut layers = Layers::default();
        layers.add("a", 0, 1);
        layers.add("a", 0, 2);
        layers.add("b", 1, 3);
        assert!(layers.take_out(&"a") && !layers.take_out(&"a"));
        assert!(layers.first(&"a").is_none());
        layers.lay("a", 2, 4);
        assert_eq!(layers.first(&"a"), Some(&mut 4));
        assert!(layers.take_out_where(|key, layer| *key == "b" && layer < 2));
        assert!(!layers.take_out_where(|key, _| *key == "b"));
        layers.lay("b", 2, 5);
        assert_eq!(layers.count(), 2);
        assert_eq!(items(layers), [4, 5]);
    }
}
