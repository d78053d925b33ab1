// Reward terms over time as a stacked area: what each adds to the reward of a step; terminations and phases as lines.

function paintTerms(context, width, height, recording) {
  const { terms, times: at, duration, frames } = recording;
  context.clearRect(0, 0, width, height);
  const x = (frame) => (width * at[frame]) / (duration || 1);
  const above = new Float64Array(frames);
  const below = new Float64Array(frames);
  const layers = terms.map(({ values }) => {
    const from = new Float64Array(frames);
    const to = new Float64Array(frames);
    for (let frame = 0; frame < frames; frame++) {
      const value = values[frame] || 0;
      const stack = value < 0 ? below : above;
      from[frame] = stack[frame];
      stack[frame] += value;
      to[frame] = stack[frame];
    }
    return [from, to];
  });
  const [low, high] = [Math.min(0, usual(below, 0.02)), Math.max(1e-9, usual(above, 0.98)) * 1.04];
  const y = (value) => height * (1 - (value - low) / (high - low));
  layers.forEach(([from, to], index) => {
    context.fillStyle = css(termColour(index));
    context.beginPath();
    for (let frame = 0; frame < frames; frame++) context.lineTo(x(frame), y(to[frame]));
    for (let frame = frames - 1; frame >= 0; frame--) context.lineTo(x(frame), y(from[frame]));
    context.fill();
  });
  context.strokeStyle = context.fillStyle = inked("ink");
  context.globalAlpha = 0.5;
  context.fillRect(0, y(0), width, 1);
  context.globalAlpha = 1;
  context.fillText(short(high / 1.04), 3, 11);
  marksOf(recording).forEach(({ time, text, failure }, index) => {
    const place = Math.min(width - 1, (width * time) / (duration || 1));
    context.setLineDash(failure ? [] : [4, 3]);
    context.lineWidth = failure ? 2 : 1;
    context.beginPath();
    context.moveTo(place, 0);
    context.lineTo(place, height);
    context.stroke();
    context.setLineDash([]);
    const size = context.measureText(text).width;
    const left = place + size + 6 > width ? place - size - 4 : place + 4;
    context.globalAlpha = 0.75;
    context.fillStyle = inked("panel");
    context.fillRect(left - 2, 14 + 14 * (index % 5), size + 4, 14);
    context.globalAlpha = 1;
    context.fillStyle = inked("ink");
    context.fillText(text, left, 25 + 14 * (index % 5));
  });
}

/** The value that a share of the steps does not exceed: one penalty at the end shall not flatten all that was before. */
function usual(values, share) {
  const sorted = Float64Array.from(values).sort();
  const extreme = share < 0.5 ? sorted[0] : sorted[sorted.length - 1];
  const found = sorted[Math.round(share * (sorted.length - 1))];
  return Math.abs(extreme) < 2 * Math.abs(found) ? extreme : found;
}

/** When conditions begin to hold, and when phases begin. */
function marksOf(recording) {
  const { terminations, finishes, phases, tracks, times: at } = recording;
  const marks = [];
  [...terminations, ...finishes].forEach((text, index) => {
    const frame = tracks.conditions[index].findIndex((holds) => holds === 1);
    if (frame >= 0) marks.push({ time: at[frame], text, failure: index < terminations.length });
  });
  if (phases.length) {
    const phase = tracks.phase[0];
    phases.forEach((text, index) => {
      const frame = phase.indexOf(index);
      if (frame > 0) marks.push({ time: at[frame], text, failure: false });
    });
  }
  return marks;
}

/** A list of the terms with what each adds at a frame. */
function termsLegend(element, recording) {
  element.replaceChildren();
  const values = recording.terms.map(({ name }, index) => {
    const row = element.appendChild(document.createElement("div"));
    const colour = row.appendChild(document.createElement("i"));
    colour.style.background = css(termColour(index));
    row.appendChild(document.createElement("span")).textContent = name;
    row.title = name;
    return row.appendChild(document.createElement("b"));
  });
  return (frame) => values.forEach((value, index) => (value.textContent = short(recording.terms[index].values[frame])));
}
