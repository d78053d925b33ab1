//! Reading and writing MJCF.
