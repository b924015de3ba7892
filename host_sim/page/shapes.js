// Bodies, joints and planes as objects of three.js. A mesh has the body's own axes; its edges show how it turns.
const roundSegments = 32;

// A circle about an axis, as a line loop.
const circle = (radius, axis, at = 0) => {
    const points = Array.from({ length: roundSegments }, (_, i) => {
        const a = 2 * Math.PI * i / roundSegments, p = [0, 0, 0];
        p[axis] = at;
        p[(axis + 1) % 3] = radius * Math.cos(a);
        p[(axis + 2) % 3] = radius * Math.sin(a);
        return new THREE.Vector3(...p);
    });
    return new THREE.BufferGeometry().setFromPoints([...points, points[0]]);
};
const segment = (a, b) => new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(...a), new THREE.Vector3(...b)]);

// The surfaces and the lines of a body's shape; the axis of round ones is z.
function geometriesOf(body) {
    const [a, b] = body.size;
    const upright = geometry => geometry.rotateX(Math.PI / 2);
    switch (body.shape) {
    case 'box': {
        const box = new THREE.BoxBufferGeometry(...body.size);
        return { surfaces: [box], lines: [new THREE.EdgesGeometry(box)] };
    }
    case 'sphere':
        return { surfaces: [new THREE.SphereBufferGeometry(a, roundSegments, roundSegments / 2)],
                 lines: [0, 1, 2].map(axis => circle(1.002 * a, axis)) };
    case 'cylinder':
        return { surfaces: [upright(new THREE.CylinderBufferGeometry(a, a, b, roundSegments))],
                 lines: [circle(a, 2, b / 2), circle(a, 2, -b / 2), segment([-a, 0, b / 2], [a, 0, b / 2]),
                         segment([-a, 0, -b / 2], [a, 0, -b / 2]), segment([a, 0, -b / 2], [a, 0, b / 2])] };
    case 'capsule': {
        const end = side => new THREE.SphereBufferGeometry(a, roundSegments, roundSegments / 2).translate(0, 0, side * b / 2);
        return { surfaces: [upright(new THREE.CylinderBufferGeometry(a, a, b, roundSegments, 1, true)), end(1), end(-1)],
                 lines: [circle(a, 2, b / 2), circle(a, 2, -b / 2), segment([a, 0, -b / 2], [a, 0, b / 2]),
                         segment([-a, 0, -b / 2], [-a, 0, b / 2])] };
    }
    case 'hoop':
        return { surfaces: [new THREE.TorusBufferGeometry(a, 0.03 * a, 8, 2 * roundSegments)],
                 lines: [segment([-a, 0, 0], [a, 0, 0]), segment([0, -a, 0], [0, a, 0])] };
    case 'points': {
        const largest = Math.max(...body.points.map(norm));
        return { surfaces: body.points.map(p => new THREE.SphereBufferGeometry(0.08 * largest, 12, 8).translate(...p)),
                 lines: body.points.map(p => segment([0, 0, 0], p)) };
    }
    default: {
        // A body without a shape: its axes; a point mass: a ball, as in `tumble run --gltf`.
        const ball = new THREE.SphereBufferGeometry(0.05, 16, 8), long = 0.3;
        return { surfaces: [ball],
                 lines: body.point_mass ? [] : [[long, 0, 0], [0, long, 0], [0, 0, long]].map(p => segment([0, 0, 0], p)) };
    }
    }
}

// The radius of a ball about the centre that holds the shape.
function reach(body) {
    const [a, b] = body.size;
    switch (body.shape) {
    case 'box': return norm(body.size) / 2;
    case 'sphere': case 'hoop': return a;
    case 'cylinder': return Math.hypot(a, b / 2);
    case 'capsule': return a + b / 2;
    case 'points': return Math.max(...body.points.map(norm));
    default: return body.point_mass ? 0.05 : 0.3;
    }
}

// A body as a group: `opacity` below 1 for ghosts. A ghost is drawn behind a surface that is at its place.
function bodyObject(body, colour, opacity) {
    const group = new THREE.Group(), { surfaces, lines } = geometriesOf(body), isGhost = opacity < 1;
    const surface = new THREE.MeshLambertMaterial(
        { color: colour, transparent: isGhost, opacity, depthWrite: !isGhost,
          polygonOffset: isGhost, polygonOffsetFactor: 2, polygonOffsetUnits: 4 });
    // Lines on a surface are dark, others have the body's colour.
    const isOnSurface = ['box', 'sphere', 'cylinder', 'capsule'].includes(body.shape) && !isGhost;
    const line = new THREE.LineBasicMaterial({ color: isOnSurface ? 0x101418 : colour });
    for (const geometry of surfaces) group.add(new THREE.Mesh(geometry, surface));
    for (const geometry of lines)
        group.add(geometry.type === 'EdgesGeometry' ? new THREE.LineSegments(geometry, line) : new THREE.Line(geometry, line));
    group.userData = { surface, colour };
    return group;
}

// A joint about the origin, which stands out of its body: a ball, a cube where it is fixed, else a pin along z, the longer
// and thinner one of a slider. `axis`: of the pin, in the body's axes.
function jointGeometry(kind, body, axis) {
    const positions = geometriesOf(body).surfaces.map(surface => surface.attributes.position.array);
    const extent = way => Math.max(...positions.map(numbers => {
        let most = 0;
        for (let i = 0; i < numbers.length; i += 3) most = Math.max(most, Math.abs(dot(numbers.subarray(i, i + 3), way)));
        return most;
    }));
    const thickness = Math.min(...[[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(extent)), edge = 2.125 * thickness;
    if (kind === 'ball') return new THREE.SphereBufferGeometry(1.25 * thickness, roundSegments / 2, roundSegments / 4);
    if (kind === 'fixed') return new THREE.BoxBufferGeometry(edge, edge, edge);
    const [radius, length] = kind === 'slider' ? [thickness / 8, 6 * extent(axis)] : [thickness / 4, 2.5 * extent(axis)];
    return new THREE.CylinderBufferGeometry(radius, radius, length, roundSegments / 2).rotateX(Math.PI / 2);
}

// An arrow that is seen through bodies, since contacts are inside.
function arrowObject() {
    const arrow = new THREE.ArrowHelper();
    for (const part of arrow.children) {
        part.material.depthTest = false;
        part.renderOrder = 1;
    }
    return arrow;
}

// A square of a plane about the foot of a point.
function planeObject(plane, about, size) {
    const length = norm(plane.normal), normal = scale(plane.normal, 1 / length);
    const foot = subtract(about, scale(normal, dot(normal, about) + plane.offset));  // offset: of the unit normal
    const group = new THREE.Group(), grid = new THREE.GridHelper(size, 20, 0x5d6b7a, 0x35404c);
    const face = new THREE.Mesh(new THREE.PlaneBufferGeometry(size, size).rotateX(-Math.PI / 2),
        new THREE.MeshLambertMaterial({ color: 0x2a333d, transparent: true, opacity: 0.55, depthWrite: false,
                                        polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    group.add(face, grid);
    group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...normal));
    group.position.set(...foot);
    group.userData.isFree = point => dot(subtract(point.toArray(), foot), normal) > 0;
    return group;
}
