// Vectors as arrays of three numbers, and quaternions as w, x, y, z.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = a => Math.hypot(a[0], a[1], a[2]);
const turned = (q, a) => {
    const u = [q[1], q[2], q[3]], t = scale(cross(u, a), 2);
    return add(add(a, scale(t, q[0])), cross(u, t));
};
const conjugate = q => [q[0], -q[1], -q[2], -q[3]];
// The angle between two orientations, rad; accurate where it is small.
const angleBetween = (a, b) => {
    const w = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    const u = [1, 2, 3].map(i => a[0] * b[i] - a[i] * b[0]);
    const c = cross([a[1], a[2], a[3]], [b[1], b[2], b[3]]);
    return 2 * Math.atan2(norm(subtract(u, c)), Math.abs(w));
};
