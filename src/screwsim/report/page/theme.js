// Colours of the page's theme.

const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// The colour at a share of a scale, from 0 to 1, mixed of its neighbours there.
function mixed(scale, share) {
  const at = Math.min(Math.max(share || 0, 0), 0.9999) * (scale.length - 1);
  const [from, to] = [scale[Math.floor(at)], scale[Math.floor(at) + 1]].map((tint) => [1, 3, 5].map((i) => parseInt(tint.slice(i, i + 2), 16)));
  return `rgb(${from.map((part, i) => Math.round(part + (to[i] - part) * (at % 1))).join(",")})`;
}

function isDark() {
  return window.matchMedia("screen and (prefers-color-scheme: dark)").matches;
}
