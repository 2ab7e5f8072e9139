// Lamps and their rays, in the laboratory.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, CylinderGeometry, DoubleSide, Group,
  InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, MeshBasicMaterial, MeshLambertMaterial,
  Quaternion, Vector3,
} from 'three';

const up = new Vector3(0, 0, 1);

// Every lamp as a short housing with its opening; a point source as a small one.
export function makeLamps(lamps, radius) {
  const group = new Group();
  const near = lamps.filter((lamp) => !lamp.far);
  if (near.length === 0) return group;
  const smallest = 0.006 * radius;
  const housing = new CylinderGeometry(1, 1, 1, 24);
  housing.rotateX(Math.PI / 2);
  housing.translate(0, 0, -0.5);
  const opening = new CircleGeometry(0.82, 24);
  opening.translate(0, 0, 0.01);
  const boxes = new InstancedMesh(housing, new MeshLambertMaterial({ color: '#59636d' }), near.length);
  const discs = new InstancedMesh(opening, new MeshBasicMaterial({ color: '#ffc247', side: DoubleSide }), near.length);
  near.forEach((lamp, i) => {
    const r = Math.max(lamp.radius, smallest);
    const matrix = new Matrix4().compose(
      new Vector3(...lamp.position),
      new Quaternion().setFromUnitVectors(up, new Vector3(...lamp.direction).normalize()),
      new Vector3(r, r, Math.min(r, 0.03 * radius)));
    boxes.setMatrixAt(i, matrix);
    discs.setMatrixAt(i, matrix);
  });
  group.add(boxes, discs);
  return group;
}

// Rays as thin lines; `set` receives their ends, six numbers per ray.
export class Rays {
  constructor() {
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({
      color: '#c77700', transparent: true, opacity: 0.24, depthWrite: false,
    }));
    this.lines.frustumCulled = false;
  }

  set(ends) {
    if (ends === this.ends) return;
    this.ends = ends;
    this.lines.geometry.setAttribute('position', new BufferAttribute(ends, 3));
  }
}
