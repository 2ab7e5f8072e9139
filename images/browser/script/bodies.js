// The body of the scene, and its surfaces on which light is measured.

import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, EdgesGeometry, FrontSide, BackSide, Group,
  LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, NearestFilter, RGBAFormat,
  SRGBColorSpace, Vector2, Vector3,
} from 'three';
import { ColourScale } from './colours.js';
import { Grid, numbers } from './data.js';

const largestWithEdges = 60000;  // triangles; with more, the edge lines would hide the body
const creaseDeg = 25;

function geometryOf(json) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(numbers(json.position), 3));
  if (json.uv) geometry.setAttribute('uv', new BufferAttribute(numbers(json.uv), 2));
  geometry.setIndex(new BufferAttribute(numbers(json.triangles), 1));
  return geometry;
}

// All parts of the body: solid, or transparent in one colour.
export function makeBody(parts, seeThrough) {
  const group = new Group();
  for (const part of parts) {
    const geometry = geometryOf(part);
    // Without vertex normals every triangle is shaded flat, as it is traced.
    const material = new MeshLambertMaterial({
      color: new Color().setRGB(...part.colour.map((byte) => byte / 255), SRGBColorSpace),
      flatShading: true, side: DoubleSide,
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2,
    });
    if (seeThrough) {
      material.color.set(seeThrough);
      Object.assign(material, { transparent: true, opacity: 0.16, depthWrite: false });
    }
    const mesh = new Mesh(geometry, material);
    mesh.name = part.name;
    group.add(mesh);
    if (geometry.index.count / 3 > largestWithEdges) continue;
    const edges = new LineSegments(
      new EdgesGeometry(geometry, creaseDeg),
      new LineBasicMaterial({ color: seeThrough || '#3a4149', transparent: true,
        opacity: seeThrough ? 0.8 : 0.55 }));
    group.add(edges);
  }
  return group;
}

// Position of (u, v) in a triangle as weights of its second and third corner; null outside.
function weights(a, b, c, p) {
  const ab = b.clone().sub(a), ac = c.clone().sub(a), ap = p.clone().sub(a);
  const twice = ab.cross(ac);
  if (twice === 0) return null;
  const s = ap.cross(ac) / twice, t = ab.cross(ap) / twice;
  const slack = 1e-6;
  return s >= -slack && t >= -slack && s + t <= 1 + slack ? [s, t] : null;
}

// A surface with a map on it.
class PaintedSurface {
  // `maps`: maps of the page by name.
  constructor(json, maps, scale) {
    this.name = json.name;
    this.map = json.map ?? null;
    this.scale = scale;
    const own = this.map === null ? json : maps.get(this.map);
    this.frames = json.frames ? json.frames.map((frame) => numbers(frame)) : [own.grid.values];
    this.grid = new Grid(own, this.frames[0], this.map === null ? null : own.grid.errors);
    this.texture = new DataTexture(
      new Uint8Array(4 * this.grid.width * this.grid.height), this.grid.width, this.grid.height, RGBAFormat);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.magFilter = this.texture.minFilter = NearestFilter;
    // The last block of a reduced map extends beyond the map's edge.
    this.texture.repeat.set(this.grid.across / this.grid.width, this.grid.up / this.grid.height);
    this.mesh = new Mesh(geometryOf(json), new MeshBasicMaterial({
      map: this.texture, alphaTest: 0.5, toneMapped: false,
      side: { front: FrontSide, back: BackSide, both: DoubleSide }[json.side],
    }));
    this.mesh.userData.surface = this;
    this.show(0);
  }

  show(light) {
    const frame = this.frames[Math.min(light, this.frames.length - 1)];
    if (frame === this.shown) return;
    this.shown = frame;
    this.grid.values = frame;
    this.texture.image.data.set(this.scale.pixels(frame));
    this.texture.needsUpdate = true;
  }

  // Position of (u, v) in the body frame; null if the map has no surface there.
  placeOf(u, v) {
    const { position, uv } = this.mesh.geometry.attributes;
    const index = this.mesh.geometry.index.array;
    const p = new Vector2(u, v);
    const corner = [new Vector2(), new Vector2(), new Vector2()];
    for (let i = 0; i < index.length; i += 3) {
      corner.forEach((c, k) => c.fromBufferAttribute(uv, index[i + k]));
      const inside = weights(...corner, p);
      if (!inside) continue;
      const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromBufferAttribute(position, index[i + k]));
      return a.multiplyScalar(1 - inside[0] - inside[1])
        .addScaledVector(b, inside[0]).addScaledVector(c, inside[1]);
    }
    return null;
  }
}

// Surfaces that are shown together and share a colour scale.
export class Painting {
  constructor(json, maps, colours) {
    this.title = json.title;
    this.unit = json.unit;
    this.scale = new ColourScale(colours[json.colours], json.low, json.high);
    this.surfaces = json.surfaces.map((surface) => new PaintedSurface(surface, maps, this.scale));
    this.group = new Group();
    for (const surface of this.surfaces) this.group.add(surface.mesh);
  }

  show(light) {
    for (const surface of this.surfaces) surface.show(light);
  }
}
