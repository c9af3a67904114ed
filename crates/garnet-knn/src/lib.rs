//! Nearest neighbours and proximity: k-NN, closest point on a mesh, signed distance, triangle intersections.
