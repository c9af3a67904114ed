// Where one looks from: angles, zoom and a shift that all panes share.

const FIELD_OF_VIEW = 0.5;
const HALF_HEIGHT = Math.tan(FIELD_OF_VIEW / 2);
const STEEPEST = Math.PI / 2;

/** Azimuth and elevation of the views that have a key. */
const VIEWS = {
  1: [0, 0],
  2: [0.65, 0.22],
  3: [Math.PI / 2, 0],
  4: [Math.PI, 0],
  5: [-Math.PI / 2, 0],
  6: [0, Math.PI / 2],
};

class Camera {
  constructor() {
    this.showAll();
  }

  showAll() {
    [this.azimuth, this.elevation] = VIEWS[2];
    this.zoom = 1;
    this.shift = [0, 0, 0];
  }

  look(view) {
    [this.azimuth, this.elevation] = VIEWS[view];
  }

  turn(right, up) {
    this.azimuth += right;
    this.elevation = Math.max(-STEEPEST, Math.min(STEEPEST, this.elevation + up));
  }

  enlarge(factor) {
    this.zoom = Math.max(0.2, Math.min(50, this.zoom * factor));
  }

  /** Axes of the view in the world: right, up, and towards the viewer. */
  axes() {
    const [sin, cos] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [rise, along] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    return [[cos, 0, -sin], [-sin * rise, along, -cos * rise], [sin * along, rise, cos * along]];
  }

  /** Moves what is seen by shares of the height of a pane. */
  move(right, up, box) {
    const height = 2 * HALF_HEIGHT * this.distance(box);
    const [x, y] = this.axes();
    for (let axis = 0; axis < 3; axis++) {
      this.shift[axis] -= height * (right * x[axis] + up * y[axis]);
    }
  }

  /** How far away the middle of a box is when it fills a pane of an aspect. */
  distance(box) {
    const half = Math.max(box.height, box.width / box.aspect) / 2;
    return (1.06 * half / HALF_HEIGHT + 0.2 * box.width) / this.zoom;
  }

  /** Matrices, columns first: the view, and the projection of the view. */
  matrices(center, box) {
    const [x, y, z] = this.axes();
    const distance = this.distance(box);
    const target = center.map((coordinate, axis) => coordinate + this.shift[axis]);
    const along = (axis) => -(axis[0] * target[0] + axis[1] * target[1] + axis[2] * target[2]);
    const view = [
      x[0], y[0], z[0], 0,
      x[1], y[1], z[1], 0,
      x[2], y[2], z[2], 0,
      along(x), along(y), along(z) - distance, 1,
    ];
    const reach = 2 * (box.width + box.height);
    const near = Math.max(distance - reach, 0.02 * distance);
    const far = distance + reach;
    const projection = [
      1 / (HALF_HEIGHT * box.aspect), 0, 0, 0,
      0, 1 / HALF_HEIGHT, 0, 0,
      0, 0, (near + far) / (near - far), -1,
      0, 0, 2 * near * far / (near - far), 0,
    ];
    return [new Float32Array(view), new Float32Array(projection)];
  }
}
