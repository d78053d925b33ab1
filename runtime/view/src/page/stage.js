// What of a recording is on the stage at a moment: copies of solids and the tubes of its muscles.

/** Length of the arrow of a force as large as the body's weight, m. */
const ARROW = 0.6;
const SMALLEST_BONE = 0.008;
/** Shapes smaller than this have coarse triangles, m. */
const SMALL = 0.045;
/** What muscles pale to that are weak or tired. */
const WEAK = [0.62, 0.64, 0.68];

class Stage {
  constructor(gl, recording) {
    this.recording = recording;
    this.pose = new Pose(recording.anatomy);
    this.ghost = new Pose(recording.anatomy);
    this.tubes = new Tubes(recording);
    this.colours = new Float32Array(4 * this.tubes.count);
    this.meshes = recording.anatomy.meshes.map((mesh) => new Solid(gl, facets(mesh)));
    this.lists = {};
    this.labels = [];
  }

  /** Brings everything to a time; `show` has the layers, `look` the theme, the colouring and what is chosen. */
  update(time, show, look) {
    const { recording, pose } = this;
    const moment = momentAt(recording, time);
    this.moment = moment;
    follow(pose, recording, moment);
    this.ghostly = show.reference && followReference(this.ghost, recording, moment);
    this.labels = [];
    this.lists = { solid: emptyLists(this.meshes.length), skin: emptyLists(this.meshes.length), ghost: emptyLists(this.meshes.length) };
    this.tubes.update(pose, moment);
    this.colour(look);
    for (const shape of recording.anatomy.shapes) {
      if (!shape.own) this.shape(this.lists.solid, pose, shape, [...look.theme.scenery, 1]);
      else if (show.skin === 2) this.shape(this.lists.solid, pose, shape, [...look.theme.skin, 1]);
      else if (show.skin === 1) this.shape(this.lists.skin, pose, shape, [...look.theme.skin, 0.55]);
      if (shape.own && this.ghostly) this.shape(this.lists.ghost, this.ghost, shape, [...look.theme.ghost, 0.5]);
    }
    if (show.bones) this.bones(look);
    if (show.contacts) this.contacts(look);
    if (show.markers) this.markers(look);
  }

  colour({ by, chosen, family }) {
    const { recording, moment } = this;
    this.tubes.muscleOf.forEach((muscle, tube) => {
      const lost = 0.75 * (1 - Math.min(1, capacity(recording, muscle, moment)));
      const rgb = blend(heat(shareOf(recording, muscle, by, moment, this.tubes.lengths[muscle])), WEAK, by === "capacity" ? 0 : lost);
      const { family: own } = recording.anatomy.muscles[muscle];
      const stands = (chosen < 0 || chosen === muscle) && (family < 0 || family === own);
      this.colours.set([...rgb, stands ? 1 : 0], 4 * tube);
    });
  }

  shape(lists, pose, { kind, body, size, position, orientation, mesh }, colour) {
    const place = pose.point(body, position);
    const turn = turnProduct(pose.turn[body], orientation);
    const put = (list, sizes, half) => list.push(...place, ...turn, ...sizes, half, ...colour);
    // Fingers and toes are many and need few triangles.
    const balls = Math.max(...size) < SMALL ? lists.small : lists.balls;
    if (kind === "sphere") put(balls, [size[0], size[0], size[0]], 0);
    else if (kind === "capsule") put(balls, [size[0], size[0], size[0]], size[1]);
    else if (kind === "ellipsoid") put(balls, size, 0);
    else if (kind === "cylinder") put(lists.cylinders, [size[0], size[0], size[1]], 0);
    else if (kind === "box") put(lists.boxes, size, 0);
    else put(lists.meshes[mesh], [1, 1, 1], 0);
  }

  bones({ theme }) {
    const { pose, recording } = this;
    recording.anatomy.bodies.forEach((body, index) => {
      if (!body.bone) return;
      const [from, to] = [pose.position[body.parent], pose.position[index]];
      const length = norm(minus(to, from));
      if (length < SMALLEST_BONE) return;
      const thickness = Math.min(0.017, Math.max(0.0028, 0.055 * length));
      this.lists.solid.bones.push(...from, ...turnToward(unit(minus(to, from))), thickness, thickness, length, 0, ...theme.bone, 1);
    });
  }

  contacts({ theme }) {
    const { recording, moment } = this;
    const { weight } = recording.anatomy;
    const column = (index) => between(recording.tracks.contacts[index], moment);
    recording.contacts.forEach((pair, index) => {
      const at = [0, 1, 2].map((axis) => column(6 * index + axis) * 1e-3);
      const force = [3, 4, 5].map((axis) => column(6 * index + axis));
      const size = norm(force);
      if (!(size > 0.02 * weight)) return;
      const length = (size / weight) * ARROW;
      const turn = turnToward(times(force, 1 / size));
      this.lists.solid.arrows.push(...at, ...turn, 0.018, 0.018, length, 0, ...theme.arrow, 1);
      this.labels.push({ at: sum(at, times(force, length / size)), text: `${Math.round(size)} N`, colour: theme.arrow });
    });
  }

  markers({ theme }) {
    const { recording, moment } = this;
    recording.markers.forEach((name, index) => {
      const at = [0, 1, 2].map((axis) => between(recording.tracks.markers[3 * index + axis], moment) * recording.quanta.length);
      this.lists.ghost.balls.push(...at, 1, 0, 0, 0, 0.05, 0.05, 0.05, 0, ...theme.marker, 0.8);
      this.lists.solid.small.push(...at, 1, 0, 0, 0, 0.009, 0.009, 0.009, 0, ...theme.marker, 1);
      this.labels.push({ at: sum(at, [0, 0, 0.07]), text: name, colour: theme.marker });
    });
  }

  /** Where the root is: what a camera follows. */
  centre() {
    return this.pose.position[this.recording.anatomy.root];
  }
}

const emptyLists = (meshes) => ({ balls: [], small: [], boxes: [], cylinders: [], bones: [], arrows: [], meshes: Array.from({ length: meshes }, () => []) });

/** What colours a muscle, 0 to 1. */
function shareOf(recording, muscle, by, moment, length) {
  const { tracks, quanta } = recording;
  if (by === "excitation") return between(tracks.excitations[muscle], moment) * quanta.excitation;
  if (by === "force") return forceAt(recording, muscle, moment);
  if (by === "fibre") return fibreLength(recording, muscle, moment, length) - 0.5;
  if (by === "capacity") return capacity(recording, muscle, moment);
  return between(tracks.activations[muscle], moment) * quanta.activation;
}

/** What a muscle can still bring up of what the healthy, fresh one can. */
function capacity({ anatomy, tracks, quanta }, muscle, moment) {
  return anatomy.muscles[muscle].strength * (1 - between(tracks.fatigued[muscle], moment) * quanta.activation);
}

/** Length of a fibre over its optimal length. */
function fibreLength(recording, muscle, moment, length) {
  const { optimal, slack } = recording.anatomy.muscles[muscle];
  if (!(optimal > 0)) return 1;
  const fibres = recording.tracks.fibres;
  return (fibres.length ? between(fibres[muscle], moment) * recording.quanta.length : length - slack) / optimal;
}
