// The part of a report in space. In: three.js, the section as slabs, the tool with its place. A wall of the part is an edge
// of the section that the graphics card turns round the axis, so that a change of the section costs its edges only.
// Coordinates: x is the machine's Z, y its X upwards, z points to the one who looks. The quarter that can be cut away lies
// between up and towards him; the tool cuts in the plane of the upper cut.
"use strict";

// The walls of a section, eight numbers each: Z and X of both ends, the normals there; and its cut faces, six numbers each:
// Z, floor and roof at both ends.
const solidOf = (slabs, tolerance) => {
  const walls = [], cuts = [];
  const normal = (edge, z, x, side) => {
    let nz = edge.r === undefined ? -edge.s : z - edge.z, nx = edge.r === undefined ? 1 : x - edge.x;
    const length = Math.hypot(nz, nx) || 1, sign = edge.r < 0 ? -side : side;
    return [sign * nz / length, sign * nx / length];
  };
  for (const slab of slabs) {
    for (const [floor, roof] of slab.rings) {
      const stops = [];
      for (const [edge, side] of [[floor, -1], [roof, 1]]) {
        const places = edgePlaces(edge, slab.from, slab.to, tolerance);
        for (let n = 1; n < places.length; n++) {
          const [[z0, x0], [z1, x1]] = [places[n - 1], places[n]];
          if (x0 > 1e-6 || x1 > 1e-6) walls.push(z0, x0, z1, x1, ...normal(edge, z0, x0, side), ...normal(edge, z1, x1, side));
        }
        for (const [z] of places) stops.push(z);
      }
      stops.sort((a, b) => a - b);
      for (let n = 1; n < stops.length; n++) {
        const [z0, z1] = [stops[n - 1], stops[n]];
        if (z1 - z0 > 1e-9) cuts.push(z0, edgeAt(floor, z0), edgeAt(roof, z0), z1, edgeAt(floor, z1), edgeAt(roof, z1));
      }
    }
  }
  uprightFaces(slabs, (z, a, b, way) => walls.push(z, a, z, b, way, 0, way, 0));
  return { walls, cuts };
};

// Triangles of a part whose threads wind, half-plane by half-plane: places and normals, and where each half-plane begins.
const woundSolid = ({ shells }) => {
  const count = shells[0].profiles.length, places = [], normals = [], starts = [];
  // Of each chord of a profile its normals at both ends: those of soft corners are the mean of both sides.
  const normalsOf = (profile) => {
    const flat = profile.slice(1).map(([z, x], n) => {
      const dz = z - profile[n][0], dx = x - profile[n][1], length = Math.hypot(dz, dx) || 1;
      return [dx / length, -dz / length];
    });
    const soft = (a, b) => {
      if (!b || a[0] * b[0] + a[1] * b[1] < 0.85) return a;
      const length = Math.hypot(a[0] + b[0], a[1] + b[1]);
      return [(a[0] + b[0]) / length, (a[1] + b[1]) / length];
    };
    const closed = profile[0] === profile.at(-1);
    return flat.map((one, n) => [soft(one, flat[n - 1] ?? (closed ? flat.at(-1) : undefined)), soft(one, flat[n + 1] ?? (closed ? flat[0] : undefined))]);
  };
  const all = shells.map(({ profiles }) => profiles.map(normalsOf));
  const put = (side, [z, x], [nz, nx]) => {
    const turn = 2 * Math.PI * side / count, c = Math.cos(turn), s = Math.sin(turn);
    places.push(z, x * c, x * s);
    normals.push(nz, nx * c, nx * s);
  };
  for (let side = 0; side < count; side++) {
    starts.push(places.length / 3);
    const next = (side + 1) % count;
    shells.forEach(({ profiles, joints }, n) => {
      const here = profiles[side], there = profiles[next], lean = all[n];
      // At the tip that one of the two normals that is more like the base's.
      const tip = (leans, at, base) => {
        const before = leans[at - 1]?.[1], behind = leans[at]?.[0];
        if (!before || !behind) return before ?? behind;
        const like = (one) => one[0] * (base[0][0] + base[1][0]) + one[1] * (base[0][1] + base[1][1]);
        return like(before) > like(behind) ? before : behind;
      };
      for (let i = 0, j = 0, k = 0; i < here.length - 1 || j < there.length - 1; k++) {
        if (joints[side][k]) {
          const base = lean[side][i];
          put(side, here[i], base[0]); put(side, here[i + 1], base[1]); put(next, there[j], tip(lean[next], j, base));
          i++;
        } else {
          const base = lean[next][j];
          put(side, here[i], tip(lean[side], i, base)); put(next, there[j + 1], base[1]); put(next, there[j], base[0]);
          j++;
        }
      }
    });
  }
  return { count, places, normals, starts };
};

const solidView = (THREE, host, { model, typed, colours, onFault }) => {
  const TURN_PARTS = 96, QUARTER = Math.PI / 2;
  const size = Math.max(model.bounds.z1 - model.bounds.z0, 2 * model.bounds.x1, 1), tolerance = size / 8000;
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  host.append(renderer.domElement);
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(28, 1, size / 100, size * 60);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  let queued = false;
  const render = () => {
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => { queued = false; renderer.render(scene, camera); });
  };
  controls.addEventListener("change", render);
  renderer.domElement.addEventListener("webglcontextlost", onFault);

  // ---- what surfaces look like -----------------------------------------------------------------------------
  const rgb = (hex) => new THREE.Vector3(...[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255));
  const SHADE = `
    vec3 shade(vec3 colour, vec3 normal, vec3 place, float gloss) {
      vec3 eye = normalize(-place), n = normalize(normal), key = normalize(vec3(-.3, .6, .75));
      if (dot(n, eye) < 0.) n = -n;
      float light = .46 + .5 * max(dot(n, key), 0.) + .16 * max(dot(n, normalize(vec3(.7, -.1, .5))), 0.);
      return colour * light + vec3(gloss * pow(max(dot(n, normalize(key + eye)), 0.), 36.));
    }`;
  const material = (colour, vertex, fragment, uniforms = {}) => new THREE.ShaderMaterial({
    side: THREE.DoubleSide, uniforms: { colour: { value: rgb(colours[colour]) }, gloss: { value: 0.28 }, ...uniforms },
    vertexShader: `varying vec3 vNormal; varying vec3 vPlace; varying vec2 vFlat;
      void put(vec3 place, vec3 normal) {
        vec4 seen = modelViewMatrix * vec4(place, 1.);
        vNormal = normalMatrix * normal; vPlace = seen.xyz; gl_Position = projectionMatrix * seen;
      }
      ${vertex}`,
    fragmentShader: `uniform vec3 colour; uniform float gloss; varying vec3 vNormal; varying vec3 vPlace; varying vec2 vFlat;
      ${SHADE} ${fragment}`,
  });
  const PLAIN = "void main() { gl_FragColor = vec4(shade(colour, vNormal, vPlace, gloss), 1.); }";
  const WALL = `attribute vec2 corner; attribute vec4 edge; attribute vec4 lean; uniform float start; uniform float sweep;
    void main() {
      float turn = start + sweep * corner.x, c = cos(turn), s = sin(turn);
      vec2 p = mix(edge.xy, edge.zw, corner.y), n = mix(lean.xy, lean.zw, corner.y);
      put(vec3(p.x, p.y * c, p.y * s), vec3(n.x, n.y * c, n.y * s));
    }`;
  const CUT = `attribute vec2 corner; attribute vec3 low; attribute vec3 high; uniform float turn;
    void main() {
      vec3 at = mix(low, high, corner.x);
      float x = mix(at.y, at.z, corner.y);
      vFlat = vec2(at.x, x);
      put(vec3(at.x, x * cos(turn), x * sin(turn)), vec3(0., sin(turn), cos(turn)));
    }`;
  const HATCHED = `uniform float pitch;
    void main() {
      float way = (vFlat.x + vFlat.y) / pitch, off = abs(fract(way) - .5) / fwidth(way);
      gl_FragColor = vec4(shade(colour, vNormal, vPlace, 0.) * mix(.8, 1., clamp(off - .2, 0., 1.)), 1.);
    }`;
  const FACE = `uniform float turn;
    void main() {
      vFlat = position.xy;
      put(vec3(position.x, position.y * cos(turn), position.y * sin(turn)), vec3(0., sin(turn), cos(turn)));
    }`;
  const SOLID = "void main() { put(position, normal); }";
  const BARE = "varying vec3 vColour; void main() { gl_FragColor = vec4(vColour, 1.); }";

  // ---- surfaces that are turned, and the faces of the cut ----------------------------------------------------
  const start = { value: QUARTER }, sweep = { value: 3 * QUARTER };
  let isOpen = true;
  const instanced = (corners, triangles, parts) => {
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("corner", new THREE.BufferAttribute(new Float32Array(corners), 2));
    geometry.setIndex(triangles);
    geometry.instanceCount = 0;
    return {
      geometry,
      // One row of numbers for each instance, split over the attributes.
      fill(numbers) {
        const width = parts.reduce((sum, [, n]) => sum + n, 0), count = numbers.length / width;
        let at = 0;
        for (const [name, n] of parts) {
          let attribute = geometry.getAttribute(name);
          if (!attribute || attribute.count < count) {
            attribute = new THREE.InstancedBufferAttribute(new Float32Array(n * Math.max(64, Math.ceil(count * 1.5))), n);
            attribute.setUsage(THREE.DynamicDrawUsage);
            geometry.setAttribute(name, attribute);
          }
          const { array } = attribute;
          for (let i = 0; i < count; i++) for (let k = 0; k < n; k++) array[n * i + k] = numbers[width * i + at + k];
          attribute.clearUpdateRanges();
          attribute.addUpdateRange(0, n * count);
          attribute.needsUpdate = true;
          at += n;
        }
        geometry.instanceCount = count;
      },
    };
  };
  const turned = () => {
    const corners = [], triangles = [];
    for (let n = 0; n <= TURN_PARTS; n++) corners.push(n / TURN_PARTS, 0, n / TURN_PARTS, 1);
    for (let n = 0; n < TURN_PARTS; n++) triangles.push(2 * n, 2 * n + 1, 2 * n + 2, 2 * n + 2, 2 * n + 1, 2 * n + 3);
    return instanced(corners, triangles, [["edge", 4], ["lean", 4]]);
  };
  const add = (geometry, look, to = scene) => {
    const mesh = new THREE.Mesh(geometry, look);
    mesh.frustumCulled = false;
    to.add(mesh);
    return mesh;
  };
  const pitch = { value: size / 45 };
  // A body of slabs: walls and both faces of the cut.
  const body = (wallColour, cutColour) => {
    const walls = turned(), cuts = instanced([0, 0, 1, 0, 0, 1, 1, 1], [0, 1, 2, 2, 1, 3], [["low", 3], ["high", 3]]);
    const looks = [material(wallColour, WALL, PLAIN, { start, sweep }),
      ...[0, QUARTER].map((turn) => material(cutColour, CUT, HATCHED, { turn: { value: turn }, pitch }))];
    const meshes = looks.map((look, n) => add(n === 0 ? walls.geometry : cuts.geometry, look));
    return {
      set(slabs) {
        const solid = solidOf(slabs, tolerance);
        walls.fill(solid.walls);
        cuts.fill(solid.cuts);
        return solid.walls.length / 8;
      },
      show(on) { meshes.forEach((mesh, n) => { mesh.visible = on && (n === 0 || isOpen); }); },
      open(on) { meshes.slice(1).forEach((mesh) => { mesh.visible = on; }); },
      recolour() { looks.forEach((look, n) => look.uniforms.colour.value.copy(rgb(colours[n === 0 ? wallColour : cutColour]))); },
    };
  };
  // The finished part, threads and all; made when it is shown first.
  const finished = (wallColour, cutColour) => {
    const { count, places, normals, starts } = woundSolid(model.wound);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normals), 3));
    const looks = [material(wallColour, SOLID, PLAIN)], meshes = [add(geometry, looks[0])];
    const shapeAt = (side) => {
      const shapes = model.wound.shells.map(({ profiles }) => {
        const shape = new THREE.Shape();
        profiles[side].forEach(([z, x], n) => (n === 0 ? shape.moveTo(z, x) : shape.lineTo(z, x)));
        return { shape, area: profiles[side].reduce((sum, [z, x], n, all) => { const [nz, nx] = all[(n + 1) % all.length]; return sum + z * nx - nz * x; }, 0) };
      });
      const outer = shapes.filter(({ area }) => area > 0).map(({ shape }) => shape);
      if (outer.length > 0) outer[0].holes = shapes.filter(({ area }) => area <= 0).map(({ shape }) => shape);
      return new THREE.ShapeGeometry(outer);
    };
    for (const [side, turn] of [[0, 0], [count / 4, QUARTER]]) {
      looks.push(material(cutColour, FACE, HATCHED, { turn: { value: turn }, pitch }));
      meshes.push(add(shapeAt(side), looks.at(-1)));
    }
    const open = (on) => {
      const first = on ? starts[count / 4] : 0;
      geometry.setDrawRange(first, places.length / 3 - first);
      meshes.slice(1).forEach((mesh) => { mesh.visible = on && meshes[0].visible; });
    };
    open(isOpen);
    return {
      open,
      show(on) { meshes[0].visible = on; open(isOpen); },
      get shown() { return meshes[0].visible; },
      recolour() { looks.forEach((look, n) => look.uniforms.colour.value.copy(rgb(colours[n === 0 ? wallColour : cutColour]))); },
    };
  };
  let wound = null;
  const part = body("steel", "cut"), fallen = body("fallen-steel", "fallen-steel");
  const plain = [];   // looks with the names of their colours
  const flat = (colour, vertex = SOLID, uniforms = {}) => {
    const look = material(colour, vertex, PLAIN, uniforms);
    look.uniforms.gloss.value = 0.08;
    plain.push([look, colour]);
    return look;
  };
  const shapeOf = (outline) => {
    const shape = new THREE.Shape();
    outlinePlaces(outline, tolerance).forEach(([z, x], n) => (n === 0 ? shape.moveTo(z, x) : shape.lineTo(z, x)));
    return shape;
  };
  const cutFaces = [];
  for (const { outline } of model.obstacles) {
    const places = outlinePlaces(outline, tolerance), walls = turned();
    walls.fill(places.flatMap(([z0, x0], n) => {
      const [z1, x1] = places[(n + 1) % places.length], length = Math.hypot(z1 - z0, x1 - x0) || 1;
      const lean = [(x1 - x0) / length, (z0 - z1) / length];
      return [z0, x0, z1, x1, ...lean, ...lean];
    }));
    add(walls.geometry, flat("holder", WALL, { start, sweep }));
    const face = new THREE.ShapeGeometry(shapeOf(outline));
    for (const turn of [0, QUARTER]) {
      const mesh = add(face, flat("holder"));
      mesh.rotation.x = turn;
      cutFaces.push(mesh);
    }
  }

  // ---- tool and path -----------------------------------------------------------------------------------------
  const INSERT_MM = 4.76, HOLDER_MM = 20;
  const toolMeshes = new Map();
  const toolGroup = new THREE.Group();
  scene.add(toolGroup);
  const meshesOf = (tool) => {
    if (!toolMeshes.has(tool)) {
      const group = new THREE.Group();
      const extrude = (outline, depth, front, colour) => {
        const geometry = new THREE.ExtrudeGeometry(shapeOf(outline), { depth, bevelEnabled: false });
        geometry.translate(0, 0, front - depth);
        add(geometry, flat(colour), group);
      };
      // The rake face lies in the plane of the axis; the holder is let in a little behind it.
      extrude(tool.cutting, INSERT_MM, 0.02, "insert");
      if (tool.body) extrude(tool.body, HOLDER_MM, -0.4, "holder");
      toolMeshes.set(tool, group);
    }
    return toolMeshes.get(tool);
  };
  let pathLines = null, pathEnds = null;
  const makePath = () => {
    const { segments, kind, along, sweep: bend } = typed, places = [], tints = [];
    const kinds = ["rapid", "feed", "thread"].map((name) => rgb(colours[name]));
    pathEnds = new Uint32Array(segments + 1);
    for (let i = 0; i < segments; i++) {
      const count = bend[i] === 0 ? 1 : Math.max(2, Math.ceil(Math.abs(bend[i]) / 0.2)), tint = kinds[kind[i]];
      for (let n = 0; n < count; n++) {
        for (const t of [n / count, (n + 1) / count]) { const [x, z] = along(i, t); places.push(z, x, 0.05); tints.push(tint.x, tint.y, tint.z); }
      }
      pathEnds[i + 1] = places.length / 3;
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    geometry.setAttribute("tint", new THREE.BufferAttribute(new Float32Array(tints), 3));
    const look = new THREE.ShaderMaterial({
      vertexShader: "attribute vec3 tint; varying vec3 vColour; void main() { vColour = tint; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.); }",
      fragmentShader: BARE,
    });
    pathLines = new THREE.LineSegments(geometry, look);
    pathLines.frustumCulled = false;
    scene.add(pathLines);
  };

  // ---- what is shown -----------------------------------------------------------------------------------------
  let version = "", pieces = -1, wallCount = 0;
  const show = (now) => {
    const { step } = model.wound ?? {}, isHeld = step === null;
    const isWound = model.wound && (isHeld ? now.section.isLast === true : now.fallen.some((piece) => piece.step === step));
    if (isWound) wound ??= finished(...(isHeld ? ["steel", "cut"] : ["fallen-steel", "fallen-steel"]));
    wound?.show(isWound);
    part.show(!(isWound && isHeld));
    if (now.section.version !== version) { version = now.section.version; wallCount = part.set(now.section.slabs); }
    if (now.fallen.length !== pieces) {
      pieces = now.fallen.length;
      fallen.set(now.fallen.filter((piece) => !isWound || piece.step !== step).flatMap((piece) => piece.slabs));
    }
    toolGroup.clear();
    if (now.tool) {
      toolGroup.add(meshesOf(now.tool));
      toolGroup.position.set(now.place[1], now.place[0], 0);
    }
    if (now.pathShown && !pathLines && typed.segments > 0) makePath();
    if (pathLines) {
      pathLines.visible = now.pathShown;
      pathLines.geometry.setDrawRange(0, pathEnds[now.segments]);
    }
    render();
  };
  const open = (on) => {
    isOpen = on;
    start.value = on ? QUARTER : 0;
    sweep.value = on ? 3 * QUARTER : 4 * QUARTER;
    part.open(on && !(wound?.shown && model.wound.step === null));
    fallen.open(on);
    wound?.open(on);
    cutFaces.forEach((mesh) => { mesh.visible = on; });
    render();
  };
  const fit = () => {
    const { z0, z1, x1 } = model.bounds, half = Math.max((z1 - z0) / 2 / Math.max(camera.aspect, 0.3), x1) * 1.25;
    const away = half / Math.tan(camera.fov * Math.PI / 360) + x1;
    controls.target.set((z0 + z1) / 2, 0, 0);
    const way = new THREE.Vector3(0.45, 0.5, 1).normalize();
    camera.position.copy(controls.target).addScaledVector(way, away);
    controls.update();
    render();
  };
  const zoom = (factor) => {
    camera.position.sub(controls.target).multiplyScalar(1 / factor).add(controls.target);
    controls.update();
    render();
  };
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = host;
    if (width === 0 || height === 0) return;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    render();
  };
  const recolour = () => {
    part.recolour();
    fallen.recolour();
    wound?.recolour();
    for (const [look, colour] of plain) look.uniforms.colour.value.copy(rgb(colours[colour]));
    if (pathLines) { scene.remove(pathLines); pathLines.geometry.dispose(); pathLines = null; }
    render();
  };
  new ResizeObserver(resize).observe(host);
  resize();
  open(true);
  fit();
  return { show, open, fit, zoom, recolour, get isOpen() { return isOpen; }, get walls() { return wallCount; },
    // What is to be said of threads: which text, or none.
    get noteKey() {
      if (wound?.shown) return "";
      const hasThreads = model.sizes.rows.some(({ kind }) => kind.endsWith("thread"));
      return model.wound ? "threads-later" : hasThreads ? "threads-rings" : "";
    },
    get isWound() { return wound?.shown === true; },
    // For tests: how many pixels show something, drawn at once.
    painted() {
      renderer.render(scene, camera);
      const gl = renderer.getContext(), pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
      gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      let count = 0;
      for (let i = 3; i < pixels.length; i += 4) if (pixels[i] > 0) count++;
      return count;
    } };
};
