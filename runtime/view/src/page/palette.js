// Colours. Scales are linear in Oklab lightness, so they read the same without colour vision.

/** sRGB (0..1) of a colour in Oklch. */
function oklch(lightness, chroma, degrees) {
  const hue = (degrees * Math.PI) / 180;
  const [a, b] = [chroma * Math.cos(hue), chroma * Math.sin(hue)];
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const gamma = (value) => {
    const v = Math.min(1, Math.max(0, value));
    return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
  };
  return [
    gamma(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    gamma(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    gamma(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

/** 256 colours from silent (dusky rose) over red and orange to fully active (light yellow), in equal steps to the eye. */
const HEAT = Array.from({ length: 256 }, (_, index) => {
  const share = index / 255;
  return oklch(0.44 + 0.47 * share, 0.095 + 0.07 * share, 2 + 98 * share);
});

/** The colour of a share, which is clipped to 0..1. */
const heat = (share) => HEAT[Math.round(255 * Math.min(1, Math.max(0, share || 0)))];

const css = ([r, g, b], alpha = 1) => `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)} / ${alpha})`;

/** Colours of reward terms: neighbours differ in lightness, too. */
const TERM_COLOURS = [
  [0.0, 0.45, 0.7], [0.9, 0.62, 0.0], [0.0, 0.62, 0.45], [0.8, 0.4, 0.65], [0.34, 0.71, 0.91], [0.84, 0.37, 0.0],
  [0.55, 0.5, 0.1], [0.45, 0.35, 0.75], [0.6, 0.6, 0.6], [0.4, 0.75, 0.3], [0.7, 0.2, 0.3], [0.2, 0.3, 0.45],
];
const termColour = (index) => TERM_COLOURS[index % TERM_COLOURS.length];

/** What the picture uses beside the scales, in light and in dark. */
const THEMES = {
  light: { sky: [0.925, 0.918, 0.9], ground: [0.87, 0.86, 0.835], line: [0.74, 0.73, 0.7], skin: [0.83, 0.68, 0.58], scenery: [0.55, 0.6, 0.65], bone: [0.93, 0.9, 0.82], ghost: [0.1, 0.42, 0.75], arrow: [0.0, 0.42, 0.33], marker: [0.75, 0.3, 0.05], tendon: [0.93, 0.9, 0.84] },
  dark: { sky: [0.1, 0.113, 0.128], ground: [0.155, 0.168, 0.185], line: [0.26, 0.275, 0.3], skin: [0.72, 0.6, 0.53], scenery: [0.42, 0.47, 0.53], bone: [0.85, 0.82, 0.75], ghost: [0.4, 0.7, 1.0], arrow: [0.25, 0.85, 0.65], marker: [1.0, 0.6, 0.25], tendon: [0.82, 0.8, 0.75] },
};
