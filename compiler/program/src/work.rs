//! Counts of visited items, for tests that bound how work grows with a text. A count is the same on every machine; a time is not.

#[cfg(any(test, feature = "counting"))]
thread_local! {
    static VISITED: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Counts items that a loop visits. Without the feature `counting` and outside of tests this does nothing.
pub fn visit(items: usize) {
    #[cfg(any(test, feature = "counting"))]
    VISITED.with(|visited| visited.set(visited.get() + items));
    let _ = items;
}

/// How many items `work` visits on this thread.
#[cfg(any(test, feature = "counting"))]
pub fn visited<T>(work: impl FnOnce() -> T) -> usize {
    let before = VISITED.with(std::cell::Cell::get);
    work();
    VISITED.with(std::cell::Cell::get) - before
}

/// Asserts that `work` visits something, and that what it visits grows with its size, not with a power of it.
#[cfg(any(test, feature = "counting"))]
pub fn assert_linear<T>(size: usize, work: impl Fn(usize) -> T) {
    let (single, double) = (visited(|| work(size)), visited(|| work(2 * size)));
    assert!(single >= size, "{single} items are visited for a size of {size}: the work is not counted");
    assert!(double <= 5 * single / 2, "{single} items are visited for a size of {size}, {double} for twice that");
}
