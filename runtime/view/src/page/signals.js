// Signals of a recording as curves: what the task reads, its metrics, joints, bodies' forces.

/** All curves that can be asked for: name, unit, and how to compute the values. */
function signalsOf(recording) {
  return (recording.curves ??= curvesOf(recording));
}

function curvesOf(recording) {
  const own = recording.signals.map(({ name, unit: unit_, values }) => ({ name, unit: unit_, values: () => values }));
  const joints = recording.anatomy.joints.flatMap(([name, at, turns]) => {
    const scale = recording.quanta.coordinate * (turns ? 180 / Math.PI : 1);
    const values = () => Float64Array.from(recording.tracks.coordinates[at], (code) => code * scale);
    return [
      { name: `${name}.q`, unit: turns ? "deg" : "m", values },
      { name: `${name}.qd`, unit: turns ? "deg/s" : "m/s", values: () => ratesOf(recording.times, values()) },
    ];
  });
  const terms = recording.terms.map(({ name, values }) => ({ name: `term ${name}`, unit: "", values: () => values }));
  const landmarks = recording.anatomy.landmarks.flatMap((landmark) => {
    const place = (axis) => (pose) => pose.point(landmark.body, landmark.point)[axis];
    return [
      { name: `${landmark.name}.height`, unit: "m", values: () => traced(recording, place(2)) },
      { name: `${landmark.name}.position.x`, unit: "m", values: () => traced(recording, place(0)) },
      { name: `${landmark.name}.position.y`, unit: "m", values: () => traced(recording, place(1)) },
      { name: `${landmark.name}.up.z`, unit: "", values: () => traced(recording, (pose) => turned(pose.turn[landmark.body], landmark.up)[2]) },
    ];
  });
  return [...own, ...terms, ...joints, ...landmarks];
}

/** The joint that turns most: what to begin with where there is nothing else. */
function liveliest(recording) {
  const spread = ([, at, turns]) => {
    const column = recording.tracks.coordinates[at];
    return turns ? Math.max(...column) - Math.min(...column) : 0;
  };
  const [first] = [...recording.anatomy.joints].sort((a, b) => spread(b) - spread(a));
  return first ? `${first[0]}.q` : "";
}

/** Rates of change, from the frames before and after. */
function ratesOf(at, values) {
  const last = values.length - 1;
  return values.map((_, frame) => {
    const [a, b] = [Math.max(0, frame - 1), Math.min(last, frame + 1)];
    return b > a ? (values[b] - values[a]) / (at[b] - at[a]) : 0;
  });
}

/** What follows from the pose, frame by frame. */
function traced(recording, read) {
  const pose = new Pose(recording.anatomy);
  return Float64Array.from(recording.times, (_, frame) => {
    follow(pose, recording, { frame, next: frame, share: 0 });
    return read(pose);
  });
}

/** The values of a curve, computed once per recording. */
function valuesOf(recording, signal) {
  recording.known ??= new Map();
  if (!recording.known.has(signal.name)) recording.known.set(signal.name, signal.values());
  return recording.known.get(signal.name);
}

/** Draws one signal of one or two recordings. */
function paintSignal(context, width, height, recordings, name, duration) {
  context.clearRect(0, 0, width, height);
  const found = recordings.map((recording) => ({ recording, signal: signalsOf(recording).find((signal) => signal.name === name) })).filter(({ signal }) => signal);
  if (!found.length) return;
  const curves = found.map(({ recording, signal }) => ({ times: recording.times, values: valuesOf(recording, signal), duration }));
  const range = rangeOf(curves.map(({ values }) => values));
  curves.forEach((curve, index) => {
    context.strokeStyle = index ? css(termColour(5)) : inked("accent");
    context.setLineDash(index ? [5, 3] : []);
    context.lineWidth = 1.5;
    strokeCurve(context, curve, [0, width], [0, height], range);
  });
  context.setLineDash([]);
  context.fillStyle = inked("quiet");
  context.fillText(`${short(range[1])} ${found[0].signal.unit}`, 3, 11);
  context.fillText(short(range[0]), 3, height - 3);
}
