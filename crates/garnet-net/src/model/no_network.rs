//! Models that are networks, in a build that runs none.

use std::path::Path;

use garnet_mesh::Point3;

use super::Model;
use crate::{
    CheckpointError, Cost, GarNetConfig, GarmentGraph, NetError, ReferenceCase, SceneInput,
};

/// A network: there is none.
#[derive(Debug)]
pub(super) enum Network {}

/// Refuses the network of the file `path`.
pub(super) fn check(path: &Path) -> Result<(), CheckpointError> {
    Err(refused(path))
}

fn refused(path: &Path) -> CheckpointError {
    let stem = path.file_stem().unwrap_or_default();
    CheckpointError::NoNetworks {
        variant: stem.to_string_lossy().into_owned(),
        path: path.to_path_buf(),
    }
}

/// Refuses to bind the bytes of the file `path`.
pub(super) fn bound(
    path: &Path,
    _bytes: Vec<u8>,
    _garment: GarmentGraph,
    _template: &[Point3],
    _rest_body: &[Point3],
) -> Result<Model, CheckpointError> {
    Err(refused(path))
}

impl Network {
    pub(super) fn config(&self) -> &GarNetConfig {
        match *self {}
    }

    pub(super) fn cost(&self, _num_vertices: usize) -> Result<Cost, NetError> {
        match *self {}
    }

    pub(super) fn num_bytes(&self) -> usize {
        match *self {}
    }

    pub(super) fn accepted(&self, _garment: GarmentGraph) -> Result<GarmentGraph, NetError> {
        match *self {}
    }

    pub(super) fn predict_on(
        &self,
        _garment: &GarmentGraph,
        _input: &SceneInput<'_>,
    ) -> Result<Vec<Point3>, NetError> {
        match *self {}
    }

    pub(super) fn add_to(
        &self,
        _case: &mut ReferenceCase,
        _garment: Option<&GarmentGraph>,
        _input: &SceneInput<'_>,
    ) -> Result<(), NetError> {
        match *self {}
    }

    pub(super) fn predict(&self, _input: &SceneInput<'_>) -> Result<Vec<Point3>, NetError> {
        match *self {}
    }
}
