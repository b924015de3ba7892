// What several engines need.

export const thin = 1e-3;  // m, half the thickness of a wheel, which is a cylinder in all engines

// A fixed box with one face on a plane, for engines without planes: place, orientation and half edges.
export function slab({ n, d }, half = 60, thick = 1) {
    const [x, y, z] = n, c = Math.sqrt((1 + y) / 2);  // of half the angle from the y axis to the normal
    const q = c < 1e-9 ? [0, 1, 0, 0] : [c, z / (2 * c), 0, -x / (2 * c)];
    return { x: n.map((a) => -a * (d + thick)), q, half: [half, thick, half] };
}

// The bodies that turn by themselves, with the orientation of each at a time from the start, s.
export function turning(scene) {
    return scene.bodies.flatMap((body, index) => {
        const rate = Math.hypot(...body.w);
        if (!body.fixed || rate === 0) return [];
        return [{ index, place: body.x, at: (time) => [Math.cos(rate * time / 2), ...body.w.map((w) => w / rate * Math.sin(rate * time / 2))] }];
    });
}
