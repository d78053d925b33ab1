// Where the bodies of a model are: the tree of joints, as the simulator places it.

/** Places and turns of all bodies, and the axis and anchor of every joint in the world. */
class Pose {
  constructor(anatomy) {
    this.anatomy = anatomy;
    this.position = anatomy.bodies.map(() => [0, 0, 0]);
    this.turn = anatomy.bodies.map(() => [1, 0, 0, 0]);
    this.axes = new Map();
  }

  /** Follows coordinates `value(index)`; `placed(index)` gives the seven numbers of a body that is placed from outside. */
  place(value, placed) {
    const { bodies } = this.anatomy;
    for (let body = 1; body < bodies.length; body++) {
      const { parent, position, orientation, joints, placed: outside } = bodies[body];
      if (outside !== undefined) {
        const at = placed(outside);
        this.position[body] = at.slice(0, 3);
        this.turn[body] = turnUnit(at.slice(3));
      } else if (joints.length === 1 && joints[0].kind === "free") {
        const q = joints[0].at;
        this.position[body] = [value(q), value(q + 1), value(q + 2)];
        this.turn[body] = turnUnit([value(q + 3), value(q + 4), value(q + 5), value(q + 6)]);
      } else {
        let at = sum(this.position[parent], turned(this.turn[parent], position));
        let turn = turnProduct(this.turn[parent], orientation);
        for (const joint of joints) [at, turn] = this.move(joint, body, at, turn, value);
        this.position[body] = at;
        this.turn[body] = turnUnit(turn);
      }
    }
  }

  move(joint, body, at, turn, value) {
    const anchor = sum(at, turned(turn, joint.anchor));
    const axis = turned(turn, joint.axis);
    this.axes.set(joint.at, { axis, anchor, body, slides: joint.kind === "slide" });
    const displacement = value(joint.at) - joint.reference;
    if (joint.kind === "slide") return [sum(at, times(axis, displacement)), turn];
    const own =
      joint.kind === "hinge"
        ? turnAbout(joint.axis, displacement)
        : turnUnit([value(joint.at), value(joint.at + 1), value(joint.at + 2), value(joint.at + 3)]);
    const next = turnProduct(turn, own);
    return [minus(anchor, turned(next, joint.anchor)), next];
  }

  /** A place of a body's frame in the world. */
  point(body, local) {
    return sum(this.position[body], turned(this.turn[body], local));
  }

  /** Whether a body hangs on another, or is it. */
  hangs(body, on) {
    while (body > on) body = this.anatomy.bodies[body].parent;
    return body === on;
  }
}

/** Puts a pose where a recording has it at a moment. */
function follow(pose, recording, moment) {
  const { tracks, quanta } = recording;
  const value = (index) => between(tracks.coordinates[index], moment) * quanta.coordinate;
  const placed = (index) => Array.from({ length: 7 }, (_, part) => between(tracks.placed[7 * index + part], moment) * quanta.coordinate);
  pose.place(value, placed);
}

/** Puts a pose where the reference motion has it; false where there is none. */
function followReference(pose, recording, moment) {
  const { tracks, quanta } = recording;
  if (!tracks.reference.length || !tracks.reference[0][moment.frame]) return false;
  const steady = tracks.reference[0][moment.next] ? moment : { ...moment, share: 0 };
  pose.place((index) => between(tracks.reference[1 + index], steady) * quanta.coordinate, () => [0, 0, 0, 1, 0, 0, 0]);
  return true;
}
