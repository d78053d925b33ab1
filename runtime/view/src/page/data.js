// The recordings: base64, DEFLATE, a JSON header and tracks of whole numbers.

/** Reads the recordings of a page from the text of its data element. */
async function unpack(text) {
  const packed = Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const contents = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  if (contents.version !== 1) throw new Error(`this page reads version 1 of recordings, found ${contents.version}`);
  const all = bytes.subarray(4 + length);
  return contents.recordings.map((entry) => decode(entry, contents.models[entry.model], all.subarray(entry.start)));
}

/** One recording with its tracks as columns over time. */
function decode(entry, anatomy, bytes) {
  const frames = entry.frames;
  const tracks = {};
  for (const [name, block] of Object.entries(entry.tracks)) tracks[name] = columnsOf(bytes, block, frames);
  const times = Float64Array.from(tracks.steps[0], (step) => step * entry.period);
  const curve = (signal, codes) => Float64Array.from(codes, (code) => (code > 1000 ? NaN : signal.low + signal.step * code));
  return {
    ...entry.caption,
    ...entry,
    anatomy,
    tracks,
    times,
    duration: times[frames - 1],
    terms: entry.terms.map((term, index) => ({ name: term.name, values: curve(term, tracks.terms[index]) })),
    signals: entry.signals.map((signal, index) => ({ ...signal, values: curve(signal, tracks.signals[index]) })),
    columnOfWrap: new Map(entry.touched.map((wrap, index) => [wrap, index * 7])),
  };
}

/** Undoes differences and byte planes: one Int32Array per column. */
function columnsOf(bytes, { offset, columns, planes }, frames) {
  const result = [];
  const first = offset + columns;
  for (let column = 0; column < columns; column++) {
    const order = bytes[offset + column];
    const values = new Int32Array(frames);
    let before = 0;
    let last = 0;
    for (let frame = 0; frame < frames; frame++) {
      let rest = 0;
      for (let plane = 0; plane < planes; plane++) rest |= bytes[first + (plane * columns + column) * frames + frame] << (8 * plane);
      rest = (rest >>> 1) ^ -(rest & 1);
      const predicted = order === 0 ? 0 : order === 2 && frame > 1 ? (2 * last - before) | 0 : last;
      before = last;
      last = (predicted + rest) | 0;
      values[frame] = last;
    }
    result.push(values);
  }
  return result;
}

/** A moment of a recording: two frames and the share of the second. */
function momentAt(recording, time) {
  const { times, frames } = recording;
  let low = 0;
  let high = frames - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= time + 1e-9) low = middle;
    else high = middle - 1;
  }
  const next = Math.min(low + 1, frames - 1);
  const span = times[next] - times[low];
  return { frame: low, next, share: span > 0 ? Math.min(1, Math.max(0, (time - times[low]) / span)) : 0 };
}

/** The force of a muscle over its peak: stored, or its activation times its gain plus its passive force. */
function forceAt({ tracks, quanta }, muscle, moment) {
  if (tracks.forces.length) return between(tracks.forces[muscle], moment) * quanta.force;
  const active = between(tracks.activations[muscle], moment) * quanta.activation * between(tracks.gains[muscle], moment);
  return (active + between(tracks.passive[muscle], moment)) * quanta.force;
}

/** A column at a moment. */
const between = (column, { frame, next, share }) => column[frame] + (column[next] - column[frame]) * share;
