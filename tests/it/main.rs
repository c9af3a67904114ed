//! Whole pipelines on small generated scenes, and the rules of the workspace.
