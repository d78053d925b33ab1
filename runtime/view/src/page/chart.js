// A chart over time: drawn once for a size and theme, with a cursor that moves over it; a pointer on it sets the time.

class Chart {
  /** `paint(context, width, height)` draws all but the cursor; `scrub(time)` is called by the pointer. */
  constructor(element, paint, scrub) {
    this.element = element;
    this.paint = paint;
    this.canvas = element.appendChild(document.createElement("canvas"));
    this.cursor = element.appendChild(document.createElement("div"));
    this.cursor.className = "cursor";
    this.left = 0;
    this.duration = 1;
    const at = (event) => {
      const box = element.getBoundingClientRect();
      const share = (event.clientX - box.left - this.left) / Math.max(1, box.width - this.left);
      scrub(Math.min(1, Math.max(0, share)) * this.duration, event);
    };
    element.addEventListener("pointerdown", (event) => {
      element.setPointerCapture(event.pointerId);
      at(event);
    });
    element.addEventListener("pointermove", (event) => event.buttons && at(event));
    new ResizeObserver(() => this.redraw()).observe(element);
  }

  redraw() {
    const { canvas, element } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [element.clientWidth, element.clientHeight];
    if (!width || !height) return;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "11px system-ui, sans-serif";
    this.paint(context, width, height);
    this.at(this.time || 0);
  }

  at(time) {
    this.time = time;
    const width = this.element.clientWidth - this.left;
    this.cursor.style.transform = `translateX(${this.left + (width * time) / (this.duration || 1)}px)`;
  }
}

/** A colour of the page's style. */
const inked = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Three or four digits. */
function short(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e5 || (size > 0 && size < 1e-3)) return value.toExponential(1);
  return value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

/** A curve through values at times, within low..high; gaps where a value is not a number. */
function strokeCurve(context, { times: at, values, duration }, [left, width], [top, height], [low, high]) {
  const y = (value) => top + height * (1 - (value - low) / (high - low || 1));
  context.beginPath();
  let down = false;
  values.forEach((value, frame) => {
    if (!Number.isFinite(value)) down = false;
    else {
      const x = left + (width * at[frame]) / (duration || 1);
      if (down) context.lineTo(x, y(value));
      else context.moveTo(x, y(value));
      down = true;
    }
  });
  context.stroke();
}

/** Smallest and largest of values, with some room. */
function rangeOf(lists) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists)
    for (const value of list)
      if (Number.isFinite(value)) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
  if (!(low <= high)) return [0, 1];
  const room = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1;
  return [low - room, high + room];
}
