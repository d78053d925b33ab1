// The muscle that is chosen: its curve over time, and its numbers at a moment.

/** The muscle whose tube is nearest to a point of the picture (clip coordinates), or -1. */
function pick(stage, camera, [x, y], aspect, reach) {
  const { tubes } = stage;
  let best = { muscle: -1, score: Infinity };
  for (let tube = 0; tube < tubes.count; tube++)
    for (let ring = 0; ring < RINGS; ring++) {
      const at = 4 * (tube * RINGS + ring);
      const [px, py, depth, before] = projected(camera.matrix, [tubes.places[at], tubes.places[at + 1], tubes.places[at + 2]]);
      const apart = Math.hypot((px - x) * aspect, py - y);
      // Of those under the pointer the nearest to the eye.
      if (before && apart < reach && apart / reach + 400 * depth < best.score) best = { muscle: tubes.muscleOf[tube], score: apart / reach + 400 * depth };
    }
  return best.muscle;
}

function paintMuscle(context, width, height, recording, muscle) {
  context.clearRect(0, 0, width, height);
  if (muscle < 0) return;
  const { tracks, quanta, times: at, duration } = recording;
  const force = Array.from(at, (_, frame) => forceAt(recording, muscle, { frame, next: frame, share: 0 }));
  const excitation = Array.from(tracks.excitations[muscle], (code) => code * quanta.excitation);
  const activation = Array.from(tracks.activations[muscle], (code) => code * quanta.activation);
  const high = force.reduce((most, value) => Math.max(most, value), 1);
  for (const [values, colour] of [[excitation, inked("accent")], [force, inked("quiet")], [activation, css(heat(0.55))]]) {
    context.strokeStyle = colour;
    context.lineWidth = 1.5;
    strokeCurve(context, { times: at, values, duration }, [0, width], [2, height - 4], [0, high]);
  }
  context.fillStyle = css(heat(0.55));
  context.fillText("activation", 3, 11);
  context.fillStyle = inked("quiet");
  context.fillText("force / peak", 64, 11);
  context.fillStyle = inked("accent");
  context.fillText("excitation", 134, 11);
}

/** Names and numbers of a muscle at the moment of a stage. */
function muscleFacts(stage, muscle) {
  const { recording, moment, tubes } = stage;
  const { tracks, quanta, anatomy } = recording;
  const { force, strength, family } = anatomy.muscles[muscle];
  const share = forceAt(recording, muscle, moment);
  const { branches, length } = pathOf(recording, stage.pose, muscle, moment);
  const facts = [
    ["Family", anatomy.families[family] || "–"],
    ["Activation", short(between(tracks.activations[muscle], moment) * quanta.activation)],
    ["Excitation", short(between(tracks.excitations[muscle], moment) * quanta.excitation)],
    ["Force", `${short(share * force)} N of ${short(force)} N`],
    ["Length", `${short(1000 * tubes.lengths[muscle])} mm`],
    ["Fibre / optimal", short(fibreLength(recording, muscle, moment, length))],
  ];
  if (strength !== 1) facts.push(["Strength", `${Math.round(100 * strength)} % of the healthy muscle`]);
  const tired = between(tracks.fatigued[muscle], moment) * quanta.activation;
  if (tired > 0) facts.push(["Fatigued", `${Math.round(100 * tired)} %`]);
  for (const { name, arm, turns } of momentArms(recording, stage.pose, branches).slice(0, 6))
    facts.push([`Moment arm, ${name}`, turns ? `${(1000 * arm).toFixed(1)} mm` : short(arm)]);
  return facts;
}

function showFacts(element, facts) {
  element.replaceChildren(
    ...facts.flatMap(([name, value]) => {
      const [term, text] = [document.createElement("dt"), document.createElement("dd")];
      [term.textContent, text.textContent] = [name, value];
      return [term, text];
    }),
  );
}
