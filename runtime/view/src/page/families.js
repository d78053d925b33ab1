// Activation of muscles over time as a heat map: a row per family, or per muscle of the family that is chosen.

/** Rows of the map: name, family, and the muscles whose mean it shows. */
function familyRows(anatomy, family) {
  const members = anatomy.families.map((name, index) => ({ name: name || "other", family: index, muscles: [] }));
  anatomy.muscles.forEach((muscle, index) => members[muscle.family].muscles.push(index));
  if (family < 0) return members;
  return members[family].muscles.map((muscle) => ({ name: anatomy.muscles[muscle].name, family, muscles: [muscle] }));
}

const FAMILY_LABELS = 128;

function paintFamilies(context, width, height, recording, rows) {
  context.clearRect(0, 0, width, height);
  if (!rows.length) return;
  const { tracks, frames, times: at, duration, quanta } = recording;
  const columns = Math.max(1, Math.round(width - FAMILY_LABELS));
  const image = context.createImageData(columns, rows.length);
  for (let column = 0; column < columns; column++) {
    const { frame } = momentAt({ times: at, frames }, ((column + 0.5) / columns) * duration);
    rows.forEach(({ muscles }, row) => {
      let total = 0;
      for (const muscle of muscles) total += tracks.activations[muscle][frame];
      const [r, g, b] = heat((total / muscles.length) * quanta.activation);
      image.data.set([255 * r, 255 * g, 255 * b, 255], 4 * (row * columns + column));
    });
  }
  const map = new OffscreenCanvas(columns, rows.length);
  map.getContext("2d").putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(map, FAMILY_LABELS, 0, width - FAMILY_LABELS, height);
  context.fillStyle = inked("ink");
  const size = height / rows.length;
  context.font = `${Math.max(7, Math.min(11, size - 1))}px system-ui, sans-serif`;
  rows.forEach(({ name }, row) => {
    if (size >= 7 || row % Math.ceil(7 / size) === 0) context.fillText(name, 0, (row + 0.5) * size + Math.min(4, size / 2), FAMILY_LABELS - 6);
  });
}
