// Data that the program wrote into the page; see content.h and content.cpp.

const types = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, u16: Uint16Array };

// An array of numbers from {"f32": "base64"} and similar; from {"u16", "low", "step"} as floats.
export function numbers(packed) {
  const type = Object.keys(types).find((name) => name in packed);
  const text = atob(packed[type]);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const raw = new types[type](bytes.buffer);
  if (type !== 'u16') return raw;
  const values = new Float32Array(raw.length);
  for (let i = 0; i < raw.length; ++i) {
    values[i] = raw[i] === 65535 ? NaN : packed.low + packed.step * raw[i];
  }
  return values;
}

// The content of the page.
export function read(document) {
  return JSON.parse(document.getElementById('run').textContent);
}

// A grid of values with the edges of its axes. `factor`: number of bins of the run per bin of the
// grid, along each side.
export class Grid {
  constructor(json, values, errors) {
    this.width = json.width;
    this.height = json.height;
    this.factor = json.factor;
    // The last block may extend beyond the edge of the map.
    this.across = json.bins[0] / json.factor;
    this.up = json.bins[1] / json.factor;
    this.values = values;
    this.errors = errors ?? null;
  }

  // Bin at fractions of the width and the height of the map, from its lower left corner.
  binAt(u, v) {
    const x = Math.min(Math.max(Math.floor(u * this.across), 0), this.width - 1);
    const y = Math.min(Math.max(Math.floor(v * this.up), 0), this.height - 1);
    return { x, y, index: y * this.width + x };
  }

  // Centre of the bin, as fractions.
  middle(bin) {
    return { u: (bin.x + 0.5) / this.across, v: (bin.y + 0.5) / this.up };
  }
}
