// Numbers of the page, as `garnet_view::Page` packs them: deltas, their bytes apart, deflated.

/** The code of a value that is infinite or not a number. */
const NOT_FINITE = 65535;

/** The bytes of a text of base64, inflated. */
async function inflated(text) {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  const inflate = new DecompressionStream("deflate-raw");
  const stream = new Blob([packed]).stream().pipeThrough(inflate);
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The number that a zigzag code stands for: 0, -1, 1, -2 … */
function signed(code) {
  return (code >>> 1) ^ -(code & 1);
}

/** Reads blocks of numbers one after the other. */
class Reader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  /** Corners of triangles `[face][3]`: each is told from the same corner of the face before. */
  faces(count) {
    const faces = new Uint32Array(3 * count);
    for (let corner = 0; corner < 3; corner++) {
      const planes = this.planes(4, count);
      let last = 0;
      for (let face = 0; face < count; face++) {
        const code = planes[0][face] | planes[1][face] << 8 | planes[2][face] << 16 | planes[3][face] << 24;
        const before = corner ? faces[3 * face + corner - 1] : last;
        last = before + signed(code) >>> 0;
        faces[3 * face + corner] = last;
      }
    }
    return faces;
  }

  /** Codes of 16 bits `[frame][item][component]`. They go on as in the two frames before; how far
   *  they are off is told from how far the item before was. */
  codes(frames, items, components) {
    const codes = new Uint16Array(frames * items * components);
    const size = items * components;
    for (let frame = 0; frame < frames; frame++) {
      for (let component = 0; component < components; component++) {
        const [low, high] = this.planes(2, items);
        let off = 0;
        for (let item = 0; item < items; item++) {
          const place = frame * size + item * components + component;
          const last = frame > 0 ? codes[place - size] : 0;
          const guess = frame > 1 ? 2 * last - codes[place - 2 * size] : last;
          off += signed(low[item] | high[item] << 8);
          codes[place] = guess + off;
        }
      }
    }
    return codes;
  }

  planes(count, length) {
    const planes = [];
    for (let plane = 0; plane < count; plane++, this.at += length) {
      planes.push(this.bytes.subarray(this.at, this.at + length));
    }
    return planes;
  }
}

/** Fills in the numbers of a scene: corners of `topologies`, codes of `meshes` and their values. */
function decode(scene, bytes) {
  const reader = new Reader(bytes);
  for (const topology of scene.topologies) {
    topology.corners = reader.faces(topology.faces);
  }
  for (const mesh of scene.meshes) {
    mesh.codes = reader.codes(mesh.origins.length, mesh.vertices, 3);
    for (const values of mesh.values) {
      values.codes = reader.codes(values.frames, mesh.vertices, 1);
    }
  }
}
