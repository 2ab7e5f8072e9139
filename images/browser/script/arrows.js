// Vectors at the body's origin: a force as a straight arrow, torques and rotations with a ring
// around it.

import {
  ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Quaternion, TorusGeometry, Vector3,
} from 'three';
import { palette } from './colours.js';

const up = new Vector3(0, 0, 1);
const colourOf = { force: palette.vermilion, torque: palette.purple, turn: palette.vermilion };
const laterColours = [palette.blue, palette.purple];

// Along z with length one; cylinders of three.js are along y.
function straight(material) {
  const group = new Group();
  const shaft = new Mesh(new CylinderGeometry(0.018, 0.018, 0.84, 16), material);
  shaft.rotation.x = Math.PI / 2;
  shaft.position.z = 0.42;
  const head = new Mesh(new ConeGeometry(0.055, 0.17, 24), material);
  head.rotation.x = Math.PI / 2;
  head.position.z = 0.915;
  group.add(shaft, head);
  return group;
}

// Three quarters of a ring around z with an arrow head, right-handed.
function ring(material) {
  const group = new Group();
  const radius = 0.2, arc = 1.5 * Math.PI;
  const body = new Mesh(new TorusGeometry(radius, 0.016, 12, 48, arc), material);
  const head = new Mesh(new ConeGeometry(0.05, 0.13, 24), material);
  head.position.set(radius * Math.cos(arc), radius * Math.sin(arc), 0);
  // A cone points along y; the ring continues along (−sin, cos).
  head.rotation.z = arc;
  group.add(body, head);
  group.position.z = 0.5;
  return group;
}

export class Arrow {
  // `metres(value)`: drawn length. `order`: number of earlier arrows of the same kind.
  constructor(json, metres, order) {
    this.name = json.name;
    this.unit = json.unit;
    this.kind = json.kind;
    this.remark = json.remark;
    this.colour = order === 0 ? colourOf[json.kind] : laterColours[(order - 1) % 2];
    this.metres = metres;
    this.group = new Group();
    this.material = new MeshBasicMaterial({ color: this.colour, transparent: true, depthTest: false });
    this.group.add(straight(this.material));
    if (json.kind !== 'force') this.group.add(ring(this.material));
    this.group.traverse((object) => { object.renderOrder = 10; });
    this.tip = new Vector3();
  }

  // `vector` and `error` in the body frame, arrays of three.
  set(vector, error) {
    const direction = new Vector3(...vector);
    this.value = direction.length();
    // Error of the component along the vector.
    this.error = this.value > 0
      ? Math.hypot(...vector.map((v, k) => v / this.value * error[k])) : Math.hypot(...error);
    this.isSignificant = this.value > 2 * this.error;
    const length = this.metres(this.value);
    this.group.visible = length > 1e-4 && this.wanted !== false;
    if (!(this.value > 0)) return;
    direction.normalize();
    this.group.quaternion.copy(new Quaternion().setFromUnitVectors(up, direction));
    this.group.scale.setScalar(length);
    this.material.opacity = this.isSignificant ? 1 : 0.35;
    this.tip.copy(direction).multiplyScalar(length * 1.04);
  }
}
