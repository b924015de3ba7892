// Vectors are arrays of three, quaternions w, x, y, z.
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a) => Math.hypot(...a);
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// From the axes of a body to the world, and back.
export function turn([w, x, y, z], v) {
    const t = cross([x, y, z], v).map((c) => 2 * c), u = cross([x, y, z], t);
    return v.map((c, i) => c + w * t[i] + u[i]);
}
export const turnBack = ([w, x, y, z], v) => turn([w, -x, -y, -z], v);

// The angle of the rotation between two orientations, rad.
export function angle(p, q) {
    const [a, b, c, d] = p, [w, x, y, z] = q;
    const v = [a * x - b * w - c * z + d * y, a * y - c * w - d * x + b * z, a * z - d * w - b * y + c * x];
    return 2 * Math.asin(Math.min(1, norm(v) / (Math.hypot(...p) * Math.hypot(...q))));
}
