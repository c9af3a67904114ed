//! Motion files and retargeting.
