//! Counts of visited items, for tests that bound how work grows with a text. A count is the same on every machine; a time is not.

#[cfg(test)]
thread_local! {
    static VISITED: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Counts items that a loop visits. Outside of tests this does nothing.
pub(crate) fn visit(items: usize) {
    #[cfg(test)]
    VISITED.with(|visited| visited.set(visited.get() + items));
    let _ = items;
}

/// How many items `work` visits on this thread.
#[cfg(test)]
pub(crate) fn visited<T>(work: impl FnOnce() -> T) -> usize {
    let before = VISITED.with(std::cell::Cell::get);
    work();
    VISITED.with(std::cell::Cell::get) - before
}

/// Asserts that `work` visits something, and that what it visits grows with its size, not with a power of it.
#[cfg(test)]
pub(crate) fn assert_linear<T>(size: usize, work: impl Fn(usize) -> T) {
    let (single, double) = (visited(|| work(size)), visited(|| work(2 * size)));
    assert!(single >= size, "{single} items are visited for a size of {size}: the work is not counted");
    assert!(double <= 5 * single / 2, "{single} items are visited for a size of {size}, {double} for twice that");
}
