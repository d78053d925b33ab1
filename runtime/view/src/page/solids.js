// Triangles of unit shapes: a ball whose halves can be drawn apart (sphere, ellipsoid, capsule), box, cylinder, bone, arrow.

/** A surface of revolution about z from a profile of [radius, z, normal outwards, normal along z, cap]. */
function lathe(profile, sides) {
  const corners = [];
  const triangles = [];
  for (const [radius, z, outwards, upwards, cap] of profile)
    for (let side = 0; side < sides; side++) {
      const angle = (2 * Math.PI * side) / sides;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      corners.push(radius * c, radius * s, z, outwards * c, outwards * s, upwards, cap);
    }
  for (let row = 0; row + 1 < profile.length; row++)
    for (let side = 0; side < sides; side++) {
      const next = (side + 1) % sides;
      const [a, b, c, d] = [row * sides + side, row * sides + next, (row + 1) * sides + side, (row + 1) * sides + next];
      triangles.push(a, b, c, b, d, c);
    }
  return { corners: new Float32Array(corners), triangles: new Uint32Array(triangles) };
}

function ball(rows, sides) {
  const profile = [];
  for (const [from, to, cap] of [[-90, 0, -1], [0, 90, 1]])
    for (let row = 0; row <= rows; row++) {
      const angle = ((from + ((to - from) * row) / rows) * Math.PI) / 180;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      profile.push([c, s, c, s, cap]);
    }
  return lathe(profile, sides);
}

const cylinder = (sides) => lathe([[0, -1, 0, -1, 0], [1, -1, 0, -1, 0], [1, -1, 1, 0, 0], [1, 1, 1, 0, 0], [1, 1, 0, 1, 0], [0, 1, 0, 1, 0]], sides);

/** A shaft between two heads, from z = 0 to 1, as thick as 1 at the heads. */
function bone(sides) {
  const rows = 14;
  const radius = (z) => 0.38 + 0.62 * Math.max(Math.exp(-(((z - 0.04) / 0.085) ** 2)), Math.exp(-(((z - 0.96) / 0.085) ** 2)));
  const profile = [[0, -0.03, 0, -1, 0]];
  for (let row = 0; row <= rows; row++) {
    const z = row / rows;
    const slope = (radius(z + 0.01) - radius(z - 0.01)) / 0.02;
    profile.push([radius(z), z, 1, -0.12 * slope, 0]);
  }
  profile.push([0, 1.03, 0, 1, 0]);
  return lathe(profile, sides);
}

/** A shaft and a head, from z = 0 to 1. */
const arrow = (sides) => lathe([[0, 0, 0, -1, 0], [0.4, 0, 0, -1, 0], [0.4, 0, 1, 0, 0], [0.4, 0.82, 1, 0, 0], [0.4, 0.82, 0, -1, 0], [1, 0.82, 0, -1, 0], [1, 0.82, 0.9, 0.4, 0], [0, 1, 0.9, 0.4, 0]], sides);

function box() {
  const corners = [];
  const triangles = [];
  for (let axis = 0; axis < 3; axis++)
    for (const sign of [-1, 1]) {
      const first = corners.length / 7;
      for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const corner = [0, 0, 0];
        [corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]] = [sign, u, v];
        const normal = [0, 0, 0];
        normal[axis] = sign;
        corners.push(...corner, ...normal, 0);
      }
      triangles.push(...[0, 1, 2, 0, 2, 3].map((index) => first + index));
    }
  return { corners: new Float32Array(corners), triangles: new Uint32Array(triangles) };
}

/** A mesh of a model, each triangle with its own normal. */
function facets({ corners, triangles }) {
  const out = [];
  const point = (index) => [0, 1, 2].map((axis) => corners[3 * index + axis] * 1e-4);
  for (let first = 0; first < triangles.length; first += 3) {
    const [a, b, c] = [0, 1, 2].map((index) => point(triangles[first + index]));
    const normal = unit(cross(minus(b, a), minus(c, a)));
    for (const corner of [a, b, c]) out.push(...corner, ...normal, 0);
  }
  return { corners: new Float32Array(out), triangles: Uint32Array.from({ length: out.length / 7 }, (_, index) => index) };
}

/** Triangles on the graphics processor, drawn many times: 15 numbers per copy (place, turn, size, half length, colour). */
class Solid {
  constructor(gl, { corners, triangles }) {
    this.gl = gl;
    this.count = triangles.length;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, corners, gl.STATIC_DRAW);
    [[0, 3, 0], [1, 3, 12], [2, 1, 24]].forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 28, offset);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    this.copies = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.copies);
    [[3, 3, 0], [4, 4, 12], [5, 4, 28], [6, 4, 44]].forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 60, offset);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
  }

  draw(copies) {
    if (!copies.length) return;
    const { gl } = this;
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.copies);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(copies), gl.DYNAMIC_DRAW);
    gl.drawElementsInstanced(gl.TRIANGLES, this.count, gl.UNSIGNED_INT, 0, copies.length / 15);
    gl.bindVertexArray(null);
  }
}
