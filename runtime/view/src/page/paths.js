// Paths of muscles: from sites and touched surfaces to lines, their lengths, and tubes with a belly between pale tendons.

/** Rings of a tube. */
const RINGS = 13;
/** Stress of a fully active muscle, N/m²: cross sections follow from forces. */
const STRESS = 6e5;
const ARC_STEP = 0.35;

/** The branches of a muscle's path in the world: vertices with their bodies, and the length of all branches. */
function pathOf(recording, pose, muscle, moment) {
  const branches = [[]];
  let length = 0;
  let pending;
  const add = (at, body, straight = true) => {
    const line = branches[branches.length - 1];
    if (line.length) length += straight ? norm(minus(at, line[line.length - 1].at)) : 0;
    line.push({ at, body, straight });
  };
  for (const point of recording.anatomy.muscles[muscle].path) {
    if (point === null) branches.push([]);
    else if (typeof point === "number") pending = point;
    else {
      const bend = pending === undefined ? null : bendOf(recording, pose, pending, moment);
      pending = undefined;
      if (bend) {
        add(bend.points[0], bend.body);
        for (const at of bend.points.slice(1)) add(at, bend.body, false);
        length += bend.length;
      }
      add(pose.point(point[0], [point[1], point[2], point[3]]), point[0]);
    }
  }
  return { branches: branches.filter((line) => line.length > 1), length };
}

/** The arc on a wrapping surface, in the world; null where the path passes it. */
function bendOf(recording, pose, index, moment) {
  const column = recording.columnOfWrap.get(index);
  if (column === undefined) return null;
  const rows = recording.tracks.wraps;
  const state = rows[column][moment.frame];
  if (!state) return null;
  const steady = rows[column][moment.next] === state ? moment : { ...moment, share: 0 };
  const value = (part) => between(rows[column + part], steady) * recording.quanta.wrap;
  const from = [value(1), value(2), value(3)];
  const to = [value(4), value(5), value(6)];
  const wrap = recording.anatomy.wraps[index];
  const { axis, angle, climb } = arcOf(wrap, from, to, state);
  const steps = Math.min(24, Math.max(1, Math.ceil(Math.abs(angle) / ARC_STEP)));
  const points = [];
  for (let step = 0; step <= steps; step++) {
    const share = step / steps;
    const local = sum(turned(turnAbout(axis, angle * share), from), times(axis, climb * share));
    points.push(pose.point(wrap.body, sum(wrap.position, turned(wrap.orientation, local))));
  }
  return { points, body: wrap.body, length: Math.hypot(angle * wrap.radius, climb) };
}

function arcOf(wrap, from, to, state) {
  if (wrap.sphere) {
    const normal = cross(from, to);
    const angle = Math.atan2(norm(normal), dot(from, to));
    return { axis: unit(normal), angle: state === 1 ? angle : angle - 2 * Math.PI, climb: 0 };
  }
  const full = 2 * Math.PI;
  const forward = (((Math.atan2(to[1], to[0]) - Math.atan2(from[1], from[0])) % full) + full) % full;
  return { axis: [0, 0, 1], angle: state === 1 ? forward : forward - full, climb: to[2] - from[2] };
}

/** Moment arms of a muscle about the joints between its ends, largest first: joint and m (a plain number along slides). */
function momentArms(recording, pose, branches) {
  const named = new Map(recording.anatomy.joints.map(([name, at, turns]) => [at, { name, turns }]));
  const found = [];
  for (const [at, { axis, anchor, body, slides }] of pose.axes) {
    if (!named.has(at)) continue;
    const speed = (vertex) => {
      if (!pose.hangs(vertex.body, body)) return [0, 0, 0];
      return slides ? axis : cross(axis, minus(vertex.at, anchor));
    };
    let shortens = 0;
    for (const line of branches)
      for (let index = 1; index < line.length; index++) {
        const [a, b] = [line[index - 1], line[index]];
        if (!b.straight || a.body === b.body) continue;
        shortens -= dot(unit(minus(b.at, a.at)), minus(speed(b), speed(a)));
      }
    if (Math.abs(shortens) > 5e-4) found.push({ ...named.get(at), at, arm: shortens });
  }
  return found.sort((a, b) => Math.abs(b.arm) - Math.abs(a.arm));
}

/** The tubes of all muscles as two textures: places with radii, normals with the share of belly. */
class Tubes {
  constructor(recording) {
    this.recording = recording;
    const { muscles } = recording.anatomy;
    // Almost all muscles have one branch; a muscle with pulleys shows each as a tube.
    this.muscleOf = muscles.flatMap((muscle, index) => Array(1 + muscle.path.filter((point) => point === null).length).fill(index));
    this.count = this.muscleOf.length;
    this.places = new Float32Array(4 * RINGS * this.count);
    this.normals = new Float32Array(4 * RINGS * this.count);
    this.lengths = new Float32Array(muscles.length);
  }

  update(pose, moment) {
    const { recording } = this;
    const { muscles } = recording.anatomy;
    let tube = 0;
    muscles.forEach((muscle, index) => {
      const { branches, length } = pathOf(recording, pose, index, moment);
      this.lengths[index] = length;
      const force = forceAt(recording, index, moment);
      for (let branch = 0; this.muscleOf[tube] === index; branch++, tube++) {
        const line = branches[branch];
        if (line) this.write(tube, line, belly(muscle, length, branches.length, force));
        else this.places.fill(0, 4 * RINGS * tube, 4 * RINGS * (tube + 1));
      }
    });
  }

  /** Writes rings at equal distances along a line. */
  write(tube, line, { radius, tendon, share }) {
    const { places, normals } = this;
    let total = 0;
    for (let index = 1; index < line.length; index++) total += norm(minus(line[index].at, line[index - 1].at));
    let [segment, passed, size] = [1, 0, norm(minus(line[1].at, line[0].at))];
    let normal = [0, 0, 0];
    for (let ring = 0; ring < RINGS; ring++) {
      const along = ring / (RINGS - 1);
      while (segment < line.length - 1 && passed + size < along * total) {
        passed += size;
        segment += 1;
        size = norm(minus(line[segment].at, line[segment - 1].at));
      }
      const [a, b] = [line[segment - 1].at, line[segment].at];
      const place = blend(a, b, size > 0 ? Math.min(1, (along * total - passed) / size) : 0);
      const tangent = unit(minus(b, a));
      // A normal that turns as little as possible from ring to ring keeps tubes from twisting.
      normal = minus(normal, times(tangent, dot(normal, tangent)));
      if (norm(normal) < 1e-3) normal = cross(tangent, Math.abs(tangent[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]);
      normal = unit(normal);
      // A spindle: the belly's profile over its share of the path, slightly towards the beginning.
      const inside = (along - 0.46 * (1 - share)) / share;
      const profile = inside > 0 && inside < 1 ? Math.sin(Math.PI * inside) ** 0.9 : 0;
      const at = 4 * (RINGS * tube + ring);
      places.set(place, at);
      places[at + 3] = tendon + Math.max(0, radius - tendon) * profile;
      normals.set(normal, at);
      normals[at + 3] = Math.min(1, profile * 2.2);
    }
  }
}

/** Radius of belly and tendon (m) of a muscle, and which share of its path the belly takes. */
function belly({ force, optimal, slack, strength }, length, branches, activeForce) {
  const section = Math.max(force, 1) / STRESS / branches;
  const fibre = Math.max(length - slack, 0.5 * optimal);
  // Fibres of a pennate muscle are short and start one beside the other, so its belly is longer than they are.
  const share = Math.min(0.9, Math.max(0.6, fibre / Math.max(length, 1e-3)));
  // The volume stays: what shortens swells; a spindle of this profile has about 0.6 of the volume of its cylinder.
  const radius = Math.sqrt((section * optimal) / (Math.PI * 0.6 * share * Math.max(length, 1e-3)));
  const swelling = 1 + 0.12 * Math.min(1.5, Math.max(0, activeForce));
  return { radius: Math.min(0.03, 0.1 * length, Math.max(0.0018, radius * swelling * Math.sqrt(Math.max(0.15, strength)))), tendon: Math.min(0.0035, 0.001 + 0.12 * radius), share };
}
