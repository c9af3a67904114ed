//! What the tests of whole pipelines share: generated scenes and the folder of outside assets.
