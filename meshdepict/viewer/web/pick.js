/* The point of a mesh that is seen at a place of its picture. */
"use strict";

/* Return [x, y, z] in world units, or null beside the mesh; x and y in pixels of the page. */
window.pickPoint = (view, x, y) => {
  const { info, positions, indices, canvas } = view;
  if (!info || !view.sight) return null;
  const matrix = view.matrix(canvas.clientWidth / canvas.clientHeight);
  const place = [(2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight];
  const count = positions.length / 3;
  const seen = new Float32Array(3 * count); // as seen: to the right, up, away from the eye
  for (let i = 0; i < count; i++) {
    for (let row = 0; row < 3; row++) {
      let sum = matrix[12 + row];
      for (let k = 0; k < 3; k++) sum += (matrix[4 * k + row] * positions[3 * i + k]) / 65535;
      seen[3 * i + row] = sum;
    }
  }
  let nearest = Infinity;
  let found = null;
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [indices[i], indices[i + 1], indices[i + 2]];
    const [a, b, c] = corners.map((corner) => [seen[3 * corner] - place[0],
      seen[3 * corner + 1] - place[1]]);
    const shares = [b[0] * c[1] - b[1] * c[0], c[0] * a[1] - c[1] * a[0],
      a[0] * b[1] - a[1] * b[0]];
    const whole = shares[0] + shares[1] + shares[2];
    if (!whole || shares.some((share) => share / whole < 0)) continue;
    const mean = (of) => corners.reduce((sum, corner, k) => sum + of(corner) * shares[k], 0) / whole;
    const depth = mean((corner) => seen[3 * corner + 2]);
    if (depth >= nearest || depth < -1) continue;
    nearest = depth;
    found = [0, 1, 2].map((k) => info.low[k]
      + (info.span[k] * mean((corner) => positions[3 * corner + k])) / 65535);
  }
  return found;
};
