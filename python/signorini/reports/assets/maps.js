// Interactive maps of a report: fields on plates by WebGL2, or on a canvas by the same formulas. No library, no request.
(() => {
  "use strict";

  const INK = "#1c2733", PALE = "#66737f", YIELDS = "#d9730d", CUT = "#9b1d8a", PROFILE = "#0b6e4f";
  const CASES = ["#0b5d8f", "#b4451f", "#5b3f9e", "#2c7a3f", "#8a6d00", "#a02860"];
  const LINES = { c: { width: 4, halo: 1.5 }, o: { colour: PALE, width: 1.4, dash: [3, 4], halo: 2.5 }, y: { colour: YIELDS, width: 4, halo: 1.5 } };
  const DISC = { colour: PALE, width: 0.8, dash: [2, 2] }, JUMP = { colour: INK, width: 0.8, dash: [5, 4] };
  const PERIMETERS = { u0: { width: 1.6, halo: 1.5 }, dead: { colour: PALE, width: 0.8, dash: [3, 3], halo: 1.5 },
    u1: { colour: "#1f5fa8", width: 1.8, halo: 2 }, uout: { colour: "#a3160f", width: 1.6, dash: [7, 4], halo: 2 } };
  const AREA = { colour: PALE, width: 1, dash: [10, 3, 2, 3] };
  const FONT = "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif";
  const MISSING = 65535, WANTED = 12000, SNAP = 7;
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const smooth = (a, b, x) => { const t = clamp((x - a) / (b - a), 0, 1); return t * t * (3 - 2 * t); };

  // --- Arrays of the page -------------------------------------------------------------------------------------------

  class Store {
    constructor(text, places) { this.text = text; this.places = places; }

    // Differences from deflated zigzag codes, whose low bytes come before their high bytes.
    async differences(number, wide = false) {
      const [begin, length] = this.places[number], size = wide ? 4 : 2;
      const coded = atob(this.text.slice(begin / 3 * 4, Math.ceil((begin + length) / 3) * 4));
      const deflated = Uint8Array.from({ length }, (_, i) => coded.charCodeAt(i));
      const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
      const bytes = new Uint8Array(await new Response(stream).arrayBuffer()), count = bytes.length / size;
      return Int32Array.from({ length: count }, (_, i) => {
        let code = 0;
        for (let b = size - 1; b >= 0; b--) code = code * 256 + bytes[b * count + i];
        return code % 2 ? -(code + 1) / 2 : code / 2;
      });
    }

    async sums(number, wide = false) {
      const result = await this.differences(number, wide);
      for (let i = 1; i < result.length; i++) result[i] += result[i - 1];
      return result;
    }
  }

  // --- Elements: 8-node quadrilaterals, and 6-node triangles [a, b, c, c, ab, bc, c, ca] ------------------------------

  const N = new Float64Array(8), DU = new Float64Array(8), DV = new Float64Array(8);
  const CORNERS = [[-1, -1], [1, -1], [1, 1], [-1, 1]];

  function shapes(triangle, u, v) {
    if (triangle) {
      const l = 1 - u - v;
      N.set([l * (2 * l - 1), u * (2 * u - 1), v * (2 * v - 1), 0, 4 * l * u, 4 * u * v, 0, 4 * v * l]);
      DU.set([1 - 4 * l, 4 * u - 1, 0, 0, 4 * (l - u), 4 * v, 0, -4 * v]);
      DV.set([1 - 4 * l, 0, 4 * v - 1, 0, -4 * u, 4 * u, 0, 4 * (l - v)]);
      return;
    }
    for (let i = 0; i < 4; i++) {
      const [a, b] = CORNERS[i], p = 1 + a * u, q = 1 + b * v;
      N[i] = p * q * (a * u + b * v - 1) / 4;
      DU[i] = a * q * (2 * a * u + b * v) / 4;
      DV[i] = b * p * (a * u + 2 * b * v) / 4;
    }
    N.set([(1 - u * u) * (1 - v) / 2, (1 - v * v) * (1 + u) / 2, (1 - u * u) * (1 + v) / 2, (1 - v * v) * (1 - u) / 2], 4);
    DU.set([-u * (1 - v), (1 - v * v) / 2, -u * (1 + v), -(1 - v * v) / 2], 4);
    DV.set([-(1 - u * u) / 2, -v * (1 + u), (1 - u * u) / 2, -v * (1 - u)], 4);
  }

  class Plate {
    static async of(about, store) {
      const plate = new Plate();
      Object.assign(plate, about, { store, loaded: new Map() });
      plate.index = await store.sums(about.index, about.wide);
      const count = plate.elements, at = (local, e) => plate.index[local * count + e];
      plate.ends = new Int32Array(2 * plate.nodes);
      for (let side = 0; side < 4; side++)
        for (let e = 0; e < count; e++) {
          const node = at(4 + side, e);
          if (node >= plate.corners) plate.ends.set([at(side, e), at((side + 1) % 4, e)], 2 * node);
        }
      [plate.x, plate.y] = await Promise.all(about.xy.map((blob) => plate.codes(blob)));
      plate.triangle = Uint8Array.from({ length: count }, (_, e) => at(2, e) === at(3, e));
      plate.tessellate();
      plate.findSides();
      const on = Object.entries(about.areas).map(async ([number, area]) =>
        [number, { ...area, on: area.on === null ? null : await store.sums(area.on) }]);
      plate.areas = Object.fromEntries(await Promise.all(on));
      return plate;
    }

    // Codes of all nodes: midside nodes relative to the mean of the ends of their sides.
    async codes(blob) {
      const differences = await this.store.differences(blob), codes = new Uint16Array(this.nodes);
      for (let i = 0, last = 0; i < this.corners; i++) codes[i] = last = (last + differences[i]) & 0xffff;
      for (let i = this.corners; i < this.nodes; i++)
        codes[i] = ((codes[this.ends[2 * i]] + codes[this.ends[2 * i + 1]]) >> 1) + differences[i];
      return codes;
    }

    // Values of a layer at nodes or on elements; NaN where missing.
    async values({ blob, first, power, nodes }) {
      const key = [blob, first, power].join(); // equal codes may be of different values
      if (!this.loaded.has(key)) {
        const codes = nodes ? await this.codes(blob) : (await this.store.sums(blob)).map((code) => code & 0xffff);
        const divisor = 10 ** Math.abs(power);
        this.loaded.set(key, Float64Array.from(codes, (code) =>
          code === MISSING ? NaN : power < 0 ? (first + code) / divisor : (first + code) * divisor));
      }
      return this.loaded.get(key);
    }

    place(node) {
      const step = this.size / 65535;
      return [this.low[0] + this.x[node] * step, this.low[1] + this.y[node] * step];
    }

    node(e, local) { return this.index[local * this.elements + e]; }

    // Vertices of a grid of d × d cells on every element, two triangles a cell.
    tessellate() {
      const d = clamp(2 * Math.round(Math.sqrt(WANTED / this.elements) / 2), 2, 10), own = (d + 1) ** 2;
      this.own = own;
      this.weights = [0, 1].map((triangle) => {
        const rows = [];
        for (let j = 0; j <= d; j++)
          for (let i = 0; i <= d; i++) {
            const u = i / d, v = j / d;
            shapes(triangle, triangle ? u * (1 - v) : 2 * u - 1, triangle ? v : 2 * v - 1);
            rows.push(Float64Array.from(N));
          }
        return rows;
      });
      this.cells = [];
      for (let j = 0; j < d; j++)
        for (let i = 0; i < d; i++) {
          const a = j * (d + 1) + i, b = a + 1, c = b + d + 1, e = a + d + 1;
          this.cells.push(a, b, c, a, c, e);
        }
      const x = Float64Array.from(this.x, (_, node) => this.place(node)[0] - this.low[0]);
      const y = Float64Array.from(this.y, (_, node) => this.place(node)[1] - this.low[1]);
      this.places = [this.atVertices(x), this.atVertices(y)];
    }

    atVertices(nodal) {
      const result = new Float32Array(this.elements * this.own), corner = new Float64Array(8);
      for (let e = 0; e < this.elements; e++) {
        for (let i = 0; i < 8; i++) corner[i] = nodal[this.node(e, i)];
        const rows = this.weights[this.triangle[e]];
        for (let k = 0; k < this.own; k++) {
          const w = rows[k];
          let sum = 0;
          for (let i = 0; i < 8; i++) if (w[i] !== 0) sum += w[i] * corner[i];
          result[e * this.own + k] = sum;
        }
      }
      return result;
    }

    // Sides [begin, middle, end] of elements: between equal elements, at the outline, and where stress nodes differ.
    findSides() {
      const sides = new Map();
      for (let e = 0; e < this.elements; e++)
        for (let side = 0; side < 4; side++) {
          const nodes = [side, 4 + side, (side + 1) % 4].map((local) => this.node(e, local));
          if (nodes[0] === nodes[2]) continue;
          const key = this.x[nodes[1]] * 65536 + this.y[nodes[1]];
          sides.set(key, [...(sides.get(key) || []), nodes]);
        }
      this.sides = { inner: [], outline: [], jump: [] };
      for (const both of sides.values()) {
        const jumps = both.length > 1 && both[0][1] !== both[1][1];
        this.sides[both.length === 1 ? "outline" : jumps ? "jump" : "inner"].push(both[0]);
      }
    }

    // Element and reference coordinates of a place; null off the plate.
    locate(x, y) {
      this.grid ||= this.makeGrid();
      const { cells, n, step } = this.grid;
      const i = Math.floor((x - this.low[0]) / step), j = Math.floor((y - this.low[1]) / step);
      let best = null;
      for (const e of (i < 0 || j < 0 || i >= n || j >= n ? [] : cells[j * n + i])) {
        const found = this.invert(e, x, y);
        if (found && (!best || found.beyond < best.beyond)) best = found;
      }
      return best && best.beyond < 0.02 ? best : null;
    }

    makeGrid() {
      const n = Math.ceil(Math.sqrt(this.elements)) + 1, step = this.size * 1.0001 / n;
      const cells = Array.from({ length: n * n }, () => []);
      for (let e = 0; e < this.elements; e++) {
        const box = this.places.map((all) => {
          const own = all.subarray(e * this.own, (e + 1) * this.own);
          return [Math.min(...own), Math.max(...own)].map((one, k) => clamp(Math.floor(one / step + 0.1 * (2 * k - 1)), 0, n - 1));
        });
        for (let j = box[1][0]; j <= box[1][1]; j++) for (let i = box[0][0]; i <= box[0][1]; i++) cells[j * n + i].push(e);
      }
      return { cells, n, step };
    }

    invert(e, x, y) {
      const triangle = this.triangle[e], nodes = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => this.node(e, i));
      const places = nodes.map((node) => this.place(node));
      let u = triangle ? 1 / 3 : 0, v = u;
      for (let turn = 0; turn < 12; turn++) {
        shapes(triangle, u, v);
        let rx = x, ry = y, a = 0, b = 0, c = 0, d = 0;
        for (let i = 0; i < 8; i++) {
          rx -= N[i] * places[i][0]; ry -= N[i] * places[i][1];
          a += DU[i] * places[i][0]; b += DV[i] * places[i][0]; c += DU[i] * places[i][1]; d += DV[i] * places[i][1];
        }
        const det = a * d - b * c, du = (d * rx - b * ry) / det, dv = (a * ry - c * rx) / det;
        if (!Number.isFinite(du + dv) || Math.abs(u) + Math.abs(v) > 9) return null;
        u += du; v += dv;
        if (Math.abs(du) + Math.abs(dv) < 1e-9) break;
      }
      const beyond = triangle ? Math.max(-u, -v, u + v - 1) : Math.max(Math.abs(u), Math.abs(v)) - 1;
      return { e, u, v, nodes, triangle, beyond };
    }

    at(found, nodal) {
      shapes(found.triangle, found.u, found.v);
      return found.nodes.reduce((sum, node, i) => N[i] ? sum + N[i] * nodal[node] : sum, 0);
    }
  }

  function inside(lines, x, y) {
    let odd = false;
    for (const line of lines)
      for (let i = 0, j = line.length - 2; i < line.length; j = i, i += 2)
        if ((line[i + 1] > y) !== (line[j + 1] > y) &&
            x < (line[j] - line[i]) * (y - line[i + 1]) / (line[j + 1] - line[i + 1]) + line[i]) odd = !odd;
    return odd;
  }

  // --- Colours: straight lines in OKLab (Ottosson 2020), so that equal steps look equal --------------------------------

  const SIGNED = [[0.34, 0.125, 262], [0.66, 0.115, 246], [0.965, 0, 0], [0.66, 0.135, 40], [0.34, 0.125, 22]];
  const RISING = [[0.965, 0.035, 100], [0.78, 0.105, 150], [0.58, 0.095, 210], [0.36, 0.115, 270]];

  function lut(stops) {
    const lab = stops.map(([L, c, h]) => [L, c * Math.cos(h * Math.PI / 180), c * Math.sin(h * Math.PI / 180)]);
    const result = new Uint8Array(256 * 4);
    for (let i = 0; i < 256; i++) {
      const t = i / 255 * (lab.length - 1), k = Math.min(Math.floor(t), lab.length - 2);
      const [L, a, b] = lab[k].map((one, j) => one + (t - k) * (lab[k + 1][j] - one));
      const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3, m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
      const s = (L - 0.0894841775 * a - 1.2914855480 * b) ** 3;
      const rgb = [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s, -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s];
      rgb.forEach((one, j) => {
        const x = clamp(one, 0, 1);
        result[4 * i + j] = Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
      });
      result[4 * i + 3] = 255;
    }
    return result;
  }

  // Colours of a range: centred on zero where it has both signs, else pale at the end that is nearer to zero.
  function scaleOf([low, high]) {
    const most = Math.max(Math.abs(low), Math.abs(high)) || 1;
    if (high - low <= 1e-9 * most) [low, high] = [low - 0.01 * most, high + 0.01 * most];
    const both = low < -1e-3 * most && high > 1e-3 * most;
    const rough = (high - low) / 12, power = Math.floor(Math.log10(rough)), ten = 10 ** power;
    const of = [1, 2, 2.5, 5, 10].find((one) => one * ten >= rough * 0.999), every = of * ten;
    const decimals = Math.max(0, (of === 2.5) - power - (of === 10));
    const stops = both ? SIGNED : Math.abs(low) > Math.abs(high) ? [...RISING].reverse() : RISING;
    return { low, high, ends: [low, high], every, decimals, colours: lut(stops), range: both ? [-most, most] : [low, high] };
  }

  const minus = (text) => text.replace(/-/g, "−");

  function plain(value, decimals, largest) {
    if (largest >= 1e7 || (largest && largest < 1e-3)) {
      const digits = Math.floor(Math.log10(Math.abs(value) || largest)) + decimals;
      return value === 0 ? "0" : minus(value.toExponential(clamp(digits, 0, 15)).replace("e+", "e"));
    }
    return minus((Math.round(value * 10 ** decimals) === 0 ? 0 : value).toFixed(clamp(decimals, 0, 15)));
  }

  // A value with the digits that are stored or, with a half-width, those of the half-width and at least four.
  function written(value, power, largest, width) {
    let decimals = -power, more = "";
    if (width !== null && width > 0) {
      let place = Math.floor(Math.log10(width));
      if (width < 3 * 10 ** place * (1 - 1e-9)) place -= 1;
      const size = Math.floor(Math.log10(Math.abs(value) || width));
      place = Math.max(place, power, size - 5);
      decimals = -Math.max(Math.min(place, size - 3), power);
      more = ` ± ${plain(Math.ceil(width / 10 ** place - 1e-9) * 10 ** place, -place, largest)}`;
    }
    return plain(value, decimals, largest) + more;
  }

  // --- Two painters of a scene with the same result: WebGL2, and a canvas where it is missing --------------------------
  // A scene has vertices `places` with `lift` and a projection; a layer has values, indices, bounds, yields.

  class Glass {
    constructor() {
      this.canvas = document.createElement("canvas");
      this.gl = this.canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
      if (!this.gl) throw new Error("no WebGL2");
      const gl = this.gl, program = gl.createProgram();
      for (const [kind, name] of [[gl.VERTEX_SHADER, "maps.vert"], [gl.FRAGMENT_SHADER, "maps.frag"]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, document.getElementById(name).textContent.trim());
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
      }
      ["placeX", "placeY", "deflection", "value"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
      gl.linkProgram(program);
      gl.useProgram(program);
      Object.assign(this, { program, buffers: new WeakMap(), colours: gl.createTexture() });
      this.canvas.addEventListener("webglcontextlost", () => { painter = new Raster(); viewers.forEach((one) => one.draw()); });
    }

    set(uniforms) {
      for (const [name, value] of Object.entries(uniforms)) {
        const at = this.gl.getUniformLocation(this.program, name);
        if (value.length === 9) this.gl.uniformMatrix3fv(at, false, value);
        else if (value.length) this.gl.uniform2f(at, ...value);
        else this.gl.uniform1f(at, value);
      }
    }

    bind(target, array) {
      const { gl, buffers } = this, buffer = buffers.get(array) || gl.createBuffer();
      gl.bindBuffer(target, buffer);
      if (!buffers.has(array)) gl.bufferData(target, array, gl.STATIC_DRAW);
      buffers.set(array, buffer);
    }

    attribute(number, array) {
      const gl = this.gl;
      if (!array) return gl.disableVertexAttribArray(number);
      this.bind(gl.ARRAY_BUFFER, array);
      gl.enableVertexAttribArray(number);
      gl.vertexAttribPointer(number, 1, gl.FLOAT, false, 0, 0);
    }

    paint(scene, layer, width, height) {
      const { gl, canvas } = this, { turn, middle, times, deep, dot, shown: { range, ends, every } } = scene, { bounds, yields } = layer;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.bindTexture(gl.TEXTURE_2D, this.colours);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, scene.shown.colours);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      const scale = [2 * scene.scale / width, 2 * scene.scale / height];
      this.set({ turn, scale, middle, times, deep, range, ends, bounds, yields, every, dot, size: height });
      [...scene.places, scene.lift, layer.values].forEach((array, i) => this.attribute(i, array));
      this.bind(gl.ELEMENT_ARRAY_BUFFER, layer.indices);
      gl.drawElements(gl.TRIANGLES, layer.indices.length, gl.UNSIGNED_INT, 0);
      return canvas;
    }
  }

  class Raster {
    paint(scene, layer, width, height) {
      const canvas = make("canvas", { width, height }), pen = canvas.getContext("2d"), image = pen.createImageData(width, height);
      const { turn, scale, middle, times, places: [x, y], lift } = scene, depth = new Float32Array(width * height).fill(Infinity);
      const [sx, sy, sz] = [0, 1, 2].map(() => new Float32Array(x.length));
      for (let i = 0; i < x.length; i++) {
        const z = lift ? -times * lift[i] : 0;
        sx[i] = width / 2 + scale * (turn[0] * x[i] + turn[1] * y[i] + turn[2] * z - middle[0]);
        sy[i] = height / 2 - scale * (turn[3] * x[i] + turn[4] * y[i] + turn[5] * z - middle[1]);
        sz[i] = turn[6] * x[i] + turn[7] * y[i] + turn[8] * z;
      }
      for (let i = 0; i < layer.indices.length; i += 3)
        this.triangle(image, depth, sx, sy, sz, layer, layer.indices.subarray(i, i + 3), scene);
      pen.putImageData(image, 0, 0);
      return canvas;
    }

    triangle({ data, width, height }, depth, sx, sy, sz, layer, [a, b, c], scene) {
      const ux = sx[b] - sx[a], uy = sy[b] - sy[a], wx = sx[c] - sx[a], wy = sy[c] - sy[a], det = ux * wy - uy * wx;
      if (!det) return;
      const slopes = (of) => {
        const p = of[b] - of[a], q = of[c] - of[a];
        return [(p * wy - q * uy) / det, (q * ux - p * wx) / det];
      };
      const [vx, vy] = slopes(layer.values), [zx, zy] = slopes(sz), g = Math.hypot(vx, vy);
      const xs = [sx[a], sx[b], sx[c]], ys = [sy[a], sy[b], sy[c]];
      const bottom = Math.min(height - 1, Math.floor(Math.max(...ys)));
      for (let j = Math.max(0, Math.ceil(Math.min(...ys) - 0.5)); j <= bottom; j++) {
        let left = Infinity, right = -Infinity;
        for (let k = 0; k < 3; k++) {
          const n = (k + 1) % 3, t = (j + 0.5 - ys[k]) / (ys[n] - ys[k]);
          if (!(t >= 0 && t <= 1)) continue;
          const at = xs[k] + t * (xs[n] - xs[k]);
          left = Math.min(left, at); right = Math.max(right, at);
        }
        const last = Math.min(width - 1, Math.floor(right - 0.5 + 1e-4));
        for (let i = Math.max(0, Math.ceil(left - 0.5 - 1e-4)); i <= last; i++) {
          const dx = i + 0.5 - sx[a], dy = j + 0.5 - sy[a], z = sz[a] + zx * dx + zy * dy, k = j * width + i;
          if (z > depth[k]) continue;
          depth[k] = z;
          shade(data, 4 * k, layer.values[a] + vx * dx + vy * dy, g, i + 0.5, j + 0.5, layer, scene);
        }
      }
    }
  }

  // The formulas of maps.frag.
  function shade(data, k, v, g, x, y, layer, { shown, dot }) {
    data[k + 3] = 255;
    if (v <= layer.bounds[0] || v >= layer.bounds[1]) {
      data.fill((x + y) % (9 * dot) < dot ? 204 : 247, k, k + 3);
      return;
    }
    const index = Math.floor(clamp((clamp(v, ...shown.ends) - shown.range[0]) / (shown.range[1] - shown.range[0]), 0, 1) * 255.999);
    let factor = 1;
    if (shown.every > 0 && g > 0) {
      const apart = shown.every / g / dot, near = Math.abs(v / shown.every - Math.round(v / shown.every)) * apart;
      const line = Math.round(v / shown.every) * shown.every, within = line > shown.ends[0] && line < shown.ends[1];
      const fade = within ? smooth(3, 9, apart) * (1 - smooth(400, 1200, apart)) : 0;
      factor = 1 - 0.45 * fade * (1 - smooth(0.3, 1.1, near));
    }
    const hatch = v >= layer.yields && (((x - y) % (7 * dot)) + 7 * dot) % (7 * dot) < dot ? 0.5 : 0;
    for (let j = 0; j < 3; j++) data[k + j] = hatch * 255 + (1 - hatch) * factor * shown.colours[4 * index + j];
  }

  let painter = null;
  const viewers = new Set();

  function makePainter() {
    try { return new Glass(); } catch { return new Raster(); }
  }

  // --- Labels on the map: written over all marks, in free places around their points ------------------------------------

  class Labels {
    constructor(pen, width, height) { Object.assign(this, { pen, width, height, taken: [], waiting: [] }); }

    keep(x, y, r) { this.taken.push([x - r, y - r, x + r, y + r]); }

    add(...label) { this.waiting.push(label); }

    finish() { this.waiting.forEach((label) => this.write(...label)); }

    // Write beside a point if there is room; a label that `must` be written takes the first place on the map.
    write(text, x, y, { colour = INK, bold = false, must = false, gap = 9 } = {}) {
      const { pen } = this;
      pen.font = `${bold ? "600 " : ""}12px ${FONT}`;
      const w = pen.measureText(text).width + 6, h = 16;
      if (x < 0 || y < 0 || x > this.width || y > this.height) return;
      const around = [1, 2.2, 3.6].flatMap((far) => [[1, 0], [-1, 0], [0, -1], [0, 1], [1, -1], [1, 1], [-1, -1], [-1, 1]]
        .map(([a, b]) => [x + a * (gap * far + w / 2) - w / 2, y + b * (gap * far + h / 2) - h / 2]));
      const within = around.filter(([a, b]) => a >= 2 && b >= 2 && a + w <= this.width - 2 && b + h <= this.height - 2);
      const free = within.find(([a, b]) => !this.taken.some((o) => a < o[2] && a + w > o[0] && b < o[3] && b + h > o[1]));
      const at = free || (must && within[0]);
      if (!at) return;
      this.taken.push([at[0], at[1], at[0] + w, at[1] + h]);
      pen.fillStyle = "rgba(255,255,255,0.86)";
      pen.beginPath();
      pen.roundRect(...at, w, h, 3);
      pen.fill();
      Object.assign(pen, { fillStyle: colour, textBaseline: "middle" });
      pen.fillText(text, at[0] + 3, at[1] + h / 2 + 0.5);
    }
  }

  const ring = (x, y, r) => Array.from({ length: 49 }, (_, i) => [x + r * Math.cos(i * Math.PI / 24), y + r * Math.sin(i * Math.PI / 24)]);

  function make(tag, properties = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties))
      if (name.startsWith("aria-") || name === "role" || name === "for") element.setAttribute(name, value);
      else element[name] = value;
    element.append(...children);
    return element;
  }

  let counted = 0;

  class Viewer {
    constructor(root) {
      const [header, content] = root.querySelectorAll("script");
      const data = JSON.parse(header.textContent), { texts, blobs, fields } = data;
      const printed = data.states.findIndex((one) => one.printed);
      const at = { state: Math.max(printed, 0), field: fields[0].name, plate: 0 }, angles = { around: 0, up: 90 };
      // A path grows without limit towards the end of equilibrium: its stops have no useful common scale.
      const shown = { own: Boolean(data.path), mesh: false, loads: false, cuts: true, supports: true, numbers: true };
      const store = new Store(content.textContent.trim(), blobs), pointers = new Map(), lines = new WeakMap();
      for (const field of fields) field.words = texts[field.name] || field.words;
      Object.assign(this, { root, data, store, texts, at, asked: at, angles, pointers, lines, with: shown, plates: [], view: null });
      this.build();
      this.ready = this.show({});
    }

    get state() { return this.data.states[this.at.state]; }
    get own() { return this.state.plates[this.at.plate]; }
    get plate() { return this.plates[this.at.plate]; }
    get unit() { return this.field.unit.replaceAll(" ", "\u00a0"); }
    get field() { return this.data.fields.find((one) => one.name === this.at.field); }
    get turned() { return this.angles.up < 90 || this.angles.around !== 0 || this.inDepth; }

    // --- Controls

    build() {
      const { texts, data } = this, id = `signorini-map-${++counted}`;
      this.controls = {};
      const labelled = (name, text, control) => {
        control.id = `${id}-${name}`;
        this.controls[name] = control;
        return make("span", { className: "control" }, make("label", { for: control.id, textContent: text }), control);
      };
      const select = (name, text, options) => {
        const control = make("select", { onchange: () => this.show({ [name]: name === "field" ? control.value : +control.value }) });
        control.append(...options);
        return labelled(name, text, control);
      };
      const option = (value, textContent) => make("option", { value, textContent });
      const named = data.states.map((one, i) => option(i, this.nameOf(one)));
      const first = make("div", { className: "row" },
        select("state", texts.state, named),
        select("field", texts.field, data.fields.map((one) => option(one.name, one.words))));
      if (data.plates.length > 1) first.append(select("plate", texts.plate, data.plates.map((one, i) => option(i, one.name))));
      const second = make("div", { className: "row checks" });
      for (const name of ["own", "supports", "cuts", "loads", "mesh"]) {
        const box = make("input", { type: "checkbox", checked: this.with[name], id: `${id}-${name}` });
        box.onchange = () => { this.with[name] = box.checked; this.refresh(); };
        this.controls[name] = box;
        second.append(make("label", { className: "check" }, box, texts[name]));
      }
      const turn = make("input", { type: "checkbox", id: `${id}-turn`, onchange: () => this.toggleDepth(turn.checked) });
      this.controls.turn = turn;
      second.append(make("label", { className: "check" }, turn, texts.turn));
      this.slider = make("div", { className: "row slider", hidden: true });
      const times = make("input", { type: "range", min: 0, max: 100, value: 40, oninput: () => this.draw() });
      this.timesText = make("output");
      this.slider.append(labelled("times", texts.times, times), this.timesText);
      this.stops = data.states.flatMap((one, i) => one.kind === "stop" ? [i] : []);
      const path = make("div", { className: "row slider", hidden: !this.stops.length });
      const stop = make("input", { type: "range", min: 0, max: Math.max(this.stops.length - 1, 0), value: 0,
        oninput: () => this.show({ state: this.stops[stop.value] }) });
      this.stopText = make("output");
      path.append(labelled("stop", texts.stop, stop), this.stopText);
      this.canvas = make("canvas", { tabIndex: 0, role: "application", "aria-label": texts.map });
      this.tip = make("div", { className: "tip", role: "status", hidden: true });
      const button = (text, name, action) => {
        this.controls[name] = make("button", { type: "button", textContent: text, title: texts[name], "aria-label": texts[name], onclick: action });
        return this.controls[name];
      };
      this.stage = make("div", { className: "stage" }, this.canvas, this.tip, make("div", { className: "buttons" },
        button("+", "in", () => this.zoom(1.4)), button("−", "out", () => this.zoom(1 / 1.4)), button("⤢", "reset", () => this.reset())));
      this.legend = make("div", { className: "legend" });
      this.key = make("ul", { className: "key" });
      this.notes = make("p", { className: "notes" });
      this.root.append(make("div", { className: "controls" }, first, path, second, this.slider), this.legend, this.stage, this.key, this.notes);
      this.listen();
    }

    nameOf(state) {
      if (state.kind === "combination") return state.words;
      if (state.kind === "stop") return state.words ? `${state.name}: ${state.words}` : state.name;
      return `${this.texts[state.kind]}${state.name ? `: ${state.name}` : ""}`;
    }

    // Load path, combination or stop, and plate that are shown.
    get caption() {
      const { data, texts, plate } = this;
      const parts = [data.path && `${texts.path} ${data.path}`, this.nameOf(this.state), data.plates.length > 1 && plate.name];
      return parts.filter(Boolean).join(", ");
    }

    listen() {
      const { canvas } = this;
      const place = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        this.pointers.set(event.pointerId, place(event));
        this.point(...place(event));
      });
      canvas.addEventListener("pointermove", (event) => {
        const now = place(event), before = this.pointers.get(event.pointerId);
        if (before) {
          const others = [...this.pointers.entries()].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
          this.pointers.set(event.pointerId, now);
          if (others.length) {
            const far = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
            this.zoom(far(now, others[0]) / Math.max(far(before, others[0]), 1), (now[0] + others[0][0]) / 2, (now[1] + others[0][1]) / 2);
            this.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
          } else if (this.inDepth && !event.shiftKey) this.rotate(now[0] - before[0], now[1] - before[1]);
          else this.pan(now[0] - before[0], now[1] - before[1]);
        }
        this.point(...now);
      });
      for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
      canvas.addEventListener("pointerleave", () => { this.tip.hidden = true; });
      canvas.addEventListener("wheel", (event) => {
        if (performance.now() - scrolled < 300 && !event.ctrlKey) return; // a page that scrolls past the map scrolls on
        event.preventDefault();
        this.zoom(Math.exp(-clamp(event.deltaY, -200, 200) / 400), ...place(event));
      }, { passive: false });
      canvas.addEventListener("keydown", (event) => {
        const step = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (step && this.inDepth && !event.shiftKey) this.rotate(-12 * step[0], -12 * step[1]);
        else if (step) this.pan(40 * step[0], 40 * step[1]);
        else if (event.key === "+" || event.key === "=") this.zoom(1.25);
        else if (event.key === "-") this.zoom(0.8);
        else if (event.key === "0") this.reset();
        else return;
        event.preventDefault();
        this.point(this.width / 2, this.height / 2, true);
      });
      canvas.addEventListener("blur", () => { this.tip.hidden = true; this.aim = null; this.draw(); });
      new ResizeObserver(() => { if (this.view && this.stage.clientWidth !== this.width) { this.size(); this.reset(); } }).observe(this.stage);
    }

    // --- What is shown

    async show(wanted) {
      const turn = this.turnCount = (this.turnCount || 0) + 1;
      const at = this.asked = { ...this.asked, ...wanted }; // includes what an earlier, unfinished call asks for
      try { this.plates[at.plate] ||= await Plate.of(this.data.plates[at.plate], this.store); } catch (error) {
        this.notes.textContent = this.texts.none;
        this.asked = this.at;
        throw error;
      }
      if (turn !== this.turnCount) return this.ready;
      const fields = this.data.states[at.state].plates[at.plate].fields;
      if (!fields[at.field]) at.field = this.data.fields.find((one) => fields[one.name])?.name ?? at.field;
      const plate = this.plates[at.plate], about = fields[at.field];
      const load = (of) => Promise.all((of ? of.layers : []).map(async (layer) => ({
        ...layer, nodal: await plate.values(layer), rows: layer.by === undefined ? null : await plate.codes(layer.by) })));
      const [layers, [deflection]] = await Promise.all([load(about), load(fields.deflection)]);
      if (turn !== this.turnCount) return this.ready;
      const samePlate = at.plate === this.at.plate && this.view;
      this.at = at;
      this.layers = layers.map((layer) => this.layer(plate, layer));
      this.canTurn = Boolean(deflection) && !["largest", "smallest"].includes(this.state.kind);
      this.deflection = this.canTurn ? deflection.nodal : null;
      this.lift = this.deflection && plate.atVertices(this.deflection);
      this.heights = new WeakMap();
      if (!samePlate) { this.size(); this.reset(); }
      if (!this.canTurn && this.inDepth) this.toggleDepth(false);
      this.refresh();
    }

    // Vertices' values and triangles of a layer: of its area's elements, and where values are known.
    layer(plate, { nodal, nodes, area, bounds = [null, null], power, limit, rows, names }) {
      const on = area === undefined ? null : plate.areas[area].on, count = plate.elements, own = plate.own;
      const known = (e) => nodes ? [0, 1, 2, 3, 4, 5, 6, 7].every((i) => !Number.isNaN(nodal[plate.node(e, i)])) : !Number.isNaN(nodal[e]);
      const kept = Array.from({ length: count }, (_, e) => e).filter((e) => (!on || on[e]) && known(e));
      const values = nodes ? plate.atVertices(nodal) : Float32Array.from({ length: count * own }, (_, i) => nodal[Math.floor(i / own)]);
      const indices = new Uint32Array(kept.length * plate.cells.length);
      kept.forEach((e, k) => plate.cells.forEach((vertex, j) => { indices[k * plate.cells.length + j] = e * own + vertex; }));
      const outline = area === undefined ? [] : plate.areas[area].outline;
      return { values, indices, nodal, nodes, on, power, outline, rows, names, bounds: [bounds[0] ?? -1e38, bounds[1] ?? 1e38],
        yields: limit ? limit * (1 - 1e-4) : 1e38 };
    }

    // The scale of a field: over all states and plates, or its own.
    range() {
      const all = this.with.own ? [this.own.fields[this.at.field]]
        : this.data.states.flatMap((state) => state.plates.map((one) => one.fields[this.at.field])).filter(Boolean);
      return [Math.min(...all.map((one) => one.range[0])), Math.max(...all.map((one) => one.range[1]))];
    }

    refresh() {
      const { controls, data } = this;
      this.shown = scaleOf(this.range());
      for (const name of ["state", "field", "plate"]) if (controls[name]) controls[name].value = this.at[name];
      for (const option of controls.field.options) option.disabled = !this.own.fields[option.value];
      for (const option of controls.state.options)
        option.disabled = !Object.keys(data.states[option.value].plates[this.at.plate].fields).length;
      controls.turn.disabled = !this.canTurn;
      const stop = this.stops.indexOf(this.at.state);
      if (stop >= 0) controls.stop.value = stop;
      this.stopText.textContent = stop < 0 ? "" : this.nameOf(this.state);
      controls.stop.setAttribute("aria-valuetext", this.stopText.textContent);
      this.drawLegend(); this.drawKey();
      this.draw();
    }

    toggleDepth(on) {
      this.inDepth = on;
      this.controls.turn.checked = on;
      this.slider.hidden = !on;
      this.angles = on ? { around: 25, up: 35 } : { around: 0, up: 90 };
      this.reset();
    }

    // --- Projection

    size() {
      this.width = this.stage.clientWidth;
      const outline = this.box([0, 1, 2].map((i) => [1, 0, 0, 0, 1, 0, 0, 0, 1].slice(3 * i, 3 * i + 3)));
      const shape = (outline[3] - outline[1]) / (outline[2] - outline[0]);
      this.height = Math.round(clamp(this.width * shape + 60, 240, Math.min(720, Math.max(300, 0.72 * window.innerHeight))));
      this.stage.style.height = `${this.height}px`;
    }

    get turn() {
      const a = this.angles.around * Math.PI / 180, e = this.angles.up * Math.PI / 180;
      const [c, s, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)];
      return [[c, -s, 0], [s * se, c * se, ce], [s * ce, c * ce, -se]];
    }

    get times() {
      if (!this.inDepth || !this.deflection) return 0;
      const most = this.deflection.reduce((m, w) => Math.max(m, Math.abs(w) || 0), 0);
      return most ? this.controls.times.value / 40 * 0.15 * this.plate.size / most : 0;
    }

    // Box [x, y, x, y] of the projected outline.
    box([right, up] = this.turn) {
      const box = [Infinity, Infinity, -Infinity, -Infinity], { times } = this;
      for (const side of this.plate.sides.outline)
        for (const node of side) {
          const [x, y] = this.plate.place(node).map((one, i) => one - this.plate.low[i]);
          const p = [right[0] * x + right[1] * y, up[0] * x + up[1] * y - (times && up[2] * times * this.deflection[node])];
          for (const i of [0, 1]) { box[i] = Math.min(box[i], p[i]); box[2 + i] = Math.max(box[2 + i], p[i]); }
        }
      return box;
    }

    reset() {
      // Room for labels, and for the buttons at the right or, on a phone, at the top.
      const box = this.box(), phone = this.width < 500, [left, right, top, bottom] = phone ? [26, 26, 52, 26] : [48, 56, 36, 36];
      const scale = Math.min((this.width - left - right) / (box[2] - box[0]), (this.height - top - bottom) / (box[3] - box[1]));
      const aside = [(right - left) / 2 / scale, (top - bottom) / 2 / scale];
      this.view = { middle: [0, 1].map((i) => (box[i] + box[2 + i]) / 2 + aside[i]), scale, whole: scale };
      this.draw();
    }

    zoom(factor, x = this.width / 2, y = this.height / 2) {
      const { view } = this, scale = clamp(view.scale * factor, view.whole / 4, view.whole * 200);
      const shift = 1 / view.scale - 1 / scale;
      view.middle = [view.middle[0] + (x - this.width / 2) * shift, view.middle[1] - (y - this.height / 2) * shift];
      view.scale = scale;
      this.draw();
    }

    pan(dx, dy) {
      this.view.middle = [this.view.middle[0] - dx / this.view.scale, this.view.middle[1] + dy / this.view.scale];
      this.draw();
    }

    rotate(dx, dy) {
      const before = this.box(), middle = this.view.middle;
      this.angles = { around: this.angles.around + 0.5 * dx, up: clamp(this.angles.up + 0.4 * dy, 5, 90) };
      const after = this.box();
      this.view.middle = [0, 1].map((i) => middle[i] + (after[i] + after[2 + i] - before[i] - before[2 + i]) / 2);
      this.draw();
    }

    project(x, y, w = 0) {
      const [right, up] = this.turn, { middle, scale } = this.view, z = -this.times * w;
      const dx = x - this.plate.low[0], dy = y - this.plate.low[1];
      return [this.width / 2 + scale * (right[0] * dx + right[1] * dy + right[2] * z - middle[0]),
        this.height / 2 - scale * (up[0] * dx + up[1] * dy + up[2] * z - middle[1])];
    }

    // Place on the plate at a point of the map; in depth the nearest point to the eye on the line of sight.
    unproject(px, py) {
      const [right, up] = this.turn, { middle, scale } = this.view, { low } = this.plate, { times } = this;
      const sx = (px - this.width / 2) / scale + middle[0], sy = (this.height / 2 - py) / scale + middle[1];
      const det = right[0] * up[1] - right[1] * up[0];
      const at = (w) => {
        const rest = sy + up[2] * times * w;
        return [(up[1] * sx - right[1] * rest) / det + low[0], (right[0] * rest - up[0] * sx) / det + low[1]];
      };
      if (!times) return at(0);
      const below = (w) => { const found = this.plate.locate(...at(w)); return found && this.plate.at(found, this.deflection) <= w; };
      const known = this.deflection.filter((w) => !Number.isNaN(w)), least = known.reduce((a, b) => Math.min(a, b), 0);
      const step = (known.reduce((a, b) => Math.max(a, b), 0) - least) / 40;
      let w = least - step, k = 0;
      while (!below(w) && k++ < 43) w += step;
      let above = w - step;
      for (let turn = 0; turn < 24; turn++) {
        const half = (above + w) / 2;
        if (below(half)) w = half; else above = half;
      }
      return at(w);
    }

    heightsOf(line) {
      if (!this.heights.has(line)) {
        const found = Array.from({ length: line.length / 2 }, (_, i) => this.plate.locate(line[2 * i], line[2 * i + 1]));
        this.heights.set(line, found.map((one) => (one ? this.plate.at(one, this.deflection) : 0)));
      }
      return this.heights.get(line);
    }

    // A line with so many points that it follows the deformed plate.
    fine(line) {
      if (!this.times) return line;
      if (!this.lines.has(line)) {
        const fine = line.slice(0, 2);
        for (let i = 2; i < line.length; i += 2) {
          const [x, y] = [line[i] - line[i - 2], line[i + 1] - line[i - 1]], count = Math.ceil(40 * Math.hypot(x, y) / this.plate.size);
          for (let k = count - 1; k >= 0; k--) fine.push(line[i] - x * k / count, line[i + 1] - y * k / count);
        }
        this.lines.set(line, fine);
      }
      return this.lines.get(line);
    }

    // Points of the map of a flat list x, y, x, y.
    projected(line) {
      const heights = this.times ? this.heightsOf(line) : null, result = [];
      for (let i = 0; i < line.length; i += 2) result.push(this.project(line[i], line[i + 1], heights ? heights[i / 2] : 0));
      return result;
    }

    // --- Values under the pointer

    // Value of the field at a place: at a node, or interpolated within its element; null off the plate.
    value(x, y, snap = 0) {
      const { plate } = this, found = plate.locate(x, y);
      if (!found) return null;
      const far = (one) => { const at = plate.place(one); return Math.hypot(at[0] - x, at[1] - y); };
      const next = found.nodes.reduce((a, b) => (far(b) < far(a) ? b : a)), node = far(next) < snap ? next : -1;
      const at = node < 0 ? [x, y] : plate.place(node), about = this.own.fields[this.at.field];
      let sum = 0, gap = true, power = -Infinity;
      for (const { nodal, nodes, on, outline, bounds, power: own } of this.layers) {
        if ((on && !on[found.e]) || (outline.length && !inside(outline, x, y))) continue;
        const value = !nodes ? nodal[found.e] : node < 0 ? plate.at(found, nodal) : nodal[node];
        power = Math.max(power, own);
        if (!(value > bounds[0] && value < bounds[1])) { if (Number.isNaN(value)) return null; continue; }
        sum += value; gap = false;
      }
      if (power === -Infinity) return null;
      const largest = Math.max(...about.range.map(Math.abs));
      const text = gap ? this.texts.gap : `${written(sum, power, largest, about.width)} ${this.unit}`.trim();
      const { rows, names } = this.layers[0];
      return { value: sum, gap, text, at, node, by: rows ? names[rows[next]] : "" };
    }

    point(px, py, keyboard = false) {
      if (!this.layers || !this.view) return;
      const [x, y] = this.unproject(px, py), found = this.value(x, y, keyboard ? 0 : SNAP / this.view.scale);
      this.aim = found && (keyboard || found.node >= 0) ? { found, keyboard } : null;
      this.tip.hidden = !found;
      if (found) {
        const step = Math.max(0, Math.ceil(Math.log10(this.view.scale) - 0.3)), { length } = this.data;
        this.tip.replaceChildren(make("b", { textContent: found.text }), make("span", {
          textContent: `${this.texts.at} ${found.at.map((one) => plain(one, step, 1)).join(", ")} ${length}`.trim() }),
          make("span", { textContent: found.by && `${this.texts.by} ${found.by}` }));
        const left = clamp(px + 14, 4, this.width - this.tip.offsetWidth - 4);
        this.tip.style.transform = `translate(${left}px, ${py > 64 ? py - this.tip.offsetHeight - 12 : py + 18}px)`;
      }
      this.draw();
    }

    // --- Drawing

    draw() {
      if (this.waiting) return;
      this.waiting = requestAnimationFrame(() => { this.waiting = 0; this.paint(); });
    }

    paint(dot = window.devicePixelRatio || 1) {
      if (!this.layers || !this.width) return;
      const { canvas, plate } = this, width = Math.round(this.width * dot), height = Math.round(this.height * dot);
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      const pen = canvas.getContext("2d"), turn = this.turn.flat();
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, width, height);
      painter ||= makePainter();
      const scene = { turn, dot, places: plate.places, lift: this.times ? this.lift : null, times: this.times,
        scale: this.view.scale * dot, middle: this.view.middle, deep: 0.2 / plate.size, shown: this.shown };
      for (const layer of this.layers) {
        pen.save();
        if (layer.outline.length) {
          pen.beginPath();
          for (const line of layer.outline) this.projected(line).forEach(([x, y], i) => (i ? pen.lineTo(x * dot, y * dot) : pen.moveTo(x * dot, y * dot)));
          pen.clip("evenodd");
        }
        pen.drawImage(painter.paint(scene, layer, width, height), 0, 0);
        pen.restore();
      }
      pen.setTransform(dot, 0, 0, dot, 0, 0);
      this.drawMarks(pen);
      const { times } = this;
      this.timesText.textContent = times ? plain(times, clamp(1 - Math.floor(Math.log10(times)), 0, 6), 1) : "";
    }

    path(pen, places, look) {
      pen.beginPath();
      places.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
      this.stroke(pen, look);
    }

    stroke(pen, { colour = INK, width = 1.5, dash = [], halo = 0 } = {}) {
      pen.lineJoin = pen.lineCap = "round";
      for (const [strokeStyle, lineWidth, dashes] of [["rgba(255,255,255,0.85)", width + halo, []], [colour, width, dash]]) {
        if (lineWidth === width && strokeStyle !== colour) continue;
        Object.assign(pen, { strokeStyle, lineWidth });
        pen.setLineDash(dashes);
        pen.stroke();
      }
      pen.setLineDash([]);
    }

    drawSides(pen, sides, look) {
      const { plate, deflection } = this, at = (node) => this.project(...plate.place(node), this.times ? deflection[node] : 0);
      pen.beginPath();
      for (const [a, m, b] of sides) {
        const [p, q, r] = [at(a), at(m), at(b)];
        pen.moveTo(...p);
        pen.quadraticCurveTo(2 * q[0] - (p[0] + r[0]) / 2, 2 * q[1] - (p[1] + r[1]) / 2, ...r);
      }
      this.stroke(pen, look);
    }

    drawMarks(pen) {
      const { plate, own, with: shown } = this, { marks, sides } = plate, labels = new Labels(pen, this.width, this.height);
      const about = own.fields[this.at.field];
      if (shown.mesh) this.drawSides(pen, sides.inner, { colour: "rgba(28,39,51,0.25)", width: 0.6 });
      if (this.times) {
        const level = (node) => this.project(...plate.place(node));
        for (const side of sides.outline) this.path(pen, side.map(level), { colour: "#aab4bd", width: 0.8 });
      }
      for (const zone of marks.zones) for (const line of zone.line) this.path(pen, this.projected(line), { colour: PALE, width: 0.8, dash: [2, 3] });
      this.drawSides(pen, sides.jump, JUMP);
      this.drawSides(pen, sides.outline, { colour: INK, width: 1.6 });
      for (const line of own.contact) this.path(pen, this.projected(line), { width: 1.8, halo: 2.5 });
      const ends = about ? about.ends.map(([text, x, y]) => [text, this.projected([x, y])[0]]) : [];
      ends.forEach(([, at]) => labels.keep(...at, 6));
      for (const [text, at] of ends) {
        for (const [a, b] of [[5, 0], [0, 5]]) this.path(pen, [[at[0] - a, at[1] - b], [at[0] + a, at[1] + b]], { halo: 3 });
        labels.add(minus(text), ...at, { bold: true, must: true });
      }
      if (about) for (const [x, y, r] of plate.discs[about.discs]) this.path(pen, this.projected(ring(x, y, r).flat()), DISC);
      for (const [kind, lines] of Object.entries(shown.supports ? marks.punching : {}))
        for (const one of lines) this.path(pen, this.projected(one), PERIMETERS[kind]);
      if (shown.loads) this.drawLoads(pen, marks.loads);
      if (shown.cuts) this.drawCuts(pen, marks, labels);
      if (shown.supports) marks.supports.forEach((one, i) => this.drawSupport(pen, one, own.supports && own.supports[i], labels));
      labels.finish();
      if (this.aim) this.drawAim(pen, this.aim);
    }

    drawAim(pen, { found, keyboard }) {
      const [x, y] = this.projected(found.at)[0];
      pen.beginPath();
      if (keyboard) { pen.moveTo(x - 9, y); pen.lineTo(x + 9, y); pen.moveTo(x, y - 9); pen.lineTo(x, y + 9); }
      pen.arc(x, y, 4.5, 0, 7);
      this.stroke(pen, { width: 1.4, halo: 2 });
    }

    drawLoads(pen, loads) {
      const cases = [...new Set(loads.map((one) => one.case))];
      for (const load of loads) {
        const colour = CASES[cases.indexOf(load.case) % CASES.length];
        for (const print of load.prints) this.path(pen, this.projected(print), { colour, width: 1, halo: 1.5 });
        for (const line of load.style === "points" ? [] : load.lines)
          this.path(pen, this.projected(line), { colour, width: load.style === "line" ? 2.5 : 1.4, dash: [7, 3], halo: 1.5 });
        for (const at of load.style === "points" ? load.lines : []) {
          const [x, y] = this.projected(at)[0];
          for (const r of load.upward ? [6, 1] : [6]) this.path(pen, ring(x, y, r), { colour, width: 1.6, halo: 2 });
          if (!load.upward) for (const s of [1, -1]) this.path(pen, [[x - 4, y - 4 * s], [x + 4, y + 4 * s]], { colour, width: 1.6 });
        }
      }
    }

    drawCuts(pen, marks, labels) {
      const cut = (line, name, look) => {
        const places = this.projected(this.fine(line));
        this.path(pen, places, { width: 1.5, halo: 2, ...look });
        if (name) labels.add(name, ...places[places.length - 1], { colour: look.colour });
      };
      for (const { name, line } of marks.sections) line.forEach((one) => cut(one, name, { colour: CUT }));
      for (const { name, line, borders } of marks.strips) {
        borders.forEach((one) => cut(one, "", { colour: CUT, width: 0.8, dash: [3, 3] }));
        line.forEach((one) => cut(one, name, { colour: CUT, width: 1.2, dash: [9, 3, 2, 3] }));
      }
      for (const { name, line } of marks.profiles) line.forEach((one) => cut(one, name, { colour: PROFILE, dash: [8, 3] }));
      for (const at of marks.probes)
        for (const s of [1, -1]) {
          const [x, y] = this.projected(at)[0];
          this.path(pen, [[x - 3.5, y - 3.5 * s], [x + 3.5, y + 3.5 * s]], { colour: PROFILE, width: 1.3, halo: 2 });
        }
    }

    drawSupport(pen, support, state, labels) {
      const letter = (i) => state && state.is ? state.is[Math.min(i, state.is.length - 1)] : "c";
      for (const print of support.prints) this.path(pen, this.projected(print), { width: 0.9, halo: 1.5 });
      if (support.style === "area") {
        for (const line of support.lines) this.path(pen, this.projected(line), AREA);
        return;
      }
      let count = 0;
      support.lines.forEach((line) => {
        const places = this.projected(line);
        if (support.style === "line") {
          for (let i = 0, end; i + 1 < places.length; i = end) {
            const is = letter(count + i);
            for (end = i + 1; end + 1 < places.length && letter(count + end) === is; end++);
            this.path(pen, places.slice(i, end + 1), LINES[is]);
          }
          count += places.length;
        } else {
          symbol(pen, places[0], support.kind, letter(count));
          labels.keep(...places[0], 7);
          count += 1;
        }
      });
      if (!state || !this.with.numbers) return;
      if (support.style === "line" && support.lines.length && support.kind !== "symmetry") {
        const longest = support.lines.reduce((a, b) => (b.length > a.length ? b : a)), places = this.projected(longest);
        labels.add(state.total, ...places[places.length >> 1]);
      } else
        state.each.forEach((force, i) => support.numbers[i] && labels.add(`${support.numbers[i]}: ${force}`, ...this.projected(support.lines[i])[0]));
    }

    // --- Legend and key

    drawLegend() {
      const { low, high, every, range, colours, decimals } = this.shown, { unit } = this, { words } = this.field;
      const most = Math.max(Math.abs(low), Math.abs(high)), at = (value) => 100 * (value - low) / (high - low);
      const stops = Array.from({ length: 65 }, (_, i) => {
        const value = low + i / 64 * (high - low), k = 4 * Math.floor(clamp((value - range[0]) / (range[1] - range[0]), 0, 1) * 255.999);
        return `rgb(${colours.subarray(k, k + 3).join()}) ${i / 0.64}%`;
      });
      const bar = make("div", { className: "bar", style: `background: linear-gradient(to right, ${stops})` });
      const ticks = make("div", { className: "ticks" });
      for (let k = Math.ceil(low / every - 1e-9); k * every <= high + 1e-9 * every; k++)
        ticks.append(make("span", { textContent: plain(k * every, decimals, most), style: `--at: ${at(k * every)}%` }));
      const title = `${words}${unit ? ` [${unit}]` : ""}`;
      this.legend.replaceChildren(make("div", { className: "title" }, make("b", { textContent: title }),
        make("span", { textContent: this.caption })), bar, ticks);
      this.canvas.setAttribute("aria-label", `${title}, ${this.caption}. ${this.texts.map}`);
    }

    drawKey() {
      const { texts, own, plate, with: shown } = this, { marks } = plate, items = [];
      const swatch = (draw) => {
        const canvas = make("canvas", { width: 60, height: 40, className: "swatch", "aria-hidden": "true" });
        const pen = canvas.getContext("2d", { willReadFrequently: true }); // without a graphics processor: faster for small pictures
        pen.scale(2, 2);
        draw(pen);
        return canvas;
      };
      const item = (draw, text) => items.push(make("li", {}, swatch(draw), text));
      const line = (look) => (pen) => this.path(pen, [[3, 10], [27, 10]], look);
      if (shown.supports) marks.supports.forEach((one, i) => {
        const state = own.supports && own.supports[i];
        item(one.style === "points" ? (pen) => symbol(pen, [15, 10], one.kind, "c")
          : line(one.style === "area" ? AREA : LINES.c), `${one.words}${state ? `; ${state.total}` : ""}`);
      });
      const letters = shown.supports && own.supports ? own.supports.map((one, i) => [marks.supports[i], one.is]) : [];
      for (const [is, text] of [["o", texts.open], ["y", texts.yields]]) {
        const found = letters.find(([one, all]) => one.style !== "area" && all.includes(is));
        if (found) item(found[0].style === "points" ? (pen) => symbol(pen, [15, 10], found[0].kind, is)
          : line(LINES[is]), text);
      }
      for (const kind of ["u1", "uout"])
        if (shown.supports && marks.punching[kind]?.length) item(line(PERIMETERS[kind]), texts[kind]);
      const bounded = this.layers.some((one) => one.bounds[0] > -1e38 || one.bounds[1] < 1e38);
      if (bounded) item((pen) => hatched(pen, "#f7f7f7", "#ccc"), texts.gap);
      if (this.layers.some((one) => one.yields < 1e38)) item((pen) => hatched(pen, "#25437f", "#92a1bf"), texts.limit);
      if (own.contact.length) item(line({ width: 1.8 }), texts.contact);
      if (plate.sides.jump.length) item(line(JUMP), texts.jump);
      if (plate.discs[own.fields[this.at.field]?.discs]?.length) item((pen) => this.path(pen, ring(15, 10, 7), DISC), texts.excluded);
      const cases = [...new Set(marks.loads.map((one) => one.case))];
      if (shown.loads) for (const load of marks.loads) item(line({ colour: CASES[cases.indexOf(load.case) % CASES.length], width: 2, dash: load.style === "points" ? [] : [7, 3] }), load.words);
      this.key.replaceChildren(...items);
      const width = own.fields[this.at.field]?.width;
      this.notes.textContent = [width ? texts.width : "", this.data.left_out ? texts.left_out : ""].filter(Boolean).join(" ");
    }
  }

  function hatched(pen, colour, lines) {
    Object.assign(pen, { fillStyle: colour, strokeStyle: lines });
    pen.fillRect(3, 4, 24, 12);
    for (const x of [3, 9, 15]) { pen.moveTo(x, 16); pen.lineTo(x + 12, 4); }
    pen.stroke();
  }

  // A support at a point: up, down, or both ways; filled if closed, hollow if open.
  function symbol(pen, [x, y], kind, is) {
    const r = 6, shapes = { down: [[0, -r], [r, r * 0.75], [-r, r * 0.75]], up: [[0, r], [r, -r * 0.75], [-r, -r * 0.75]] };
    const points = shapes[kind] || [[0, -r], [r, 0], [0, r], [-r, 0]];
    pen.beginPath();
    points.forEach(([a, b], i) => (i ? pen.lineTo(x + a, y + b) : pen.moveTo(x + a, y + b)));
    pen.closePath();
    pen.lineJoin = "round";
    Object.assign(pen, { strokeStyle: "#fff", lineWidth: 4 });
    pen.stroke();
    Object.assign(pen, { fillStyle: is === "o" ? "#fff" : is === "y" ? YIELDS : INK, strokeStyle: INK, lineWidth: 1.4 });
    pen.fill();
    pen.stroke();
  }

  let scrolled = -Infinity;
  document.addEventListener("scroll", () => { scrolled = performance.now(); }, { passive: true });

  // Make a map of an element of `map_html`; `ready` of the viewer is a promise of its first picture.
  function mount(element) {
    const viewer = new Viewer(element);
    viewers.add(viewer);
    element.signoriniMap = viewer;
    return viewer;
  }

  // For tests: draw without WebGL2.
  const useCanvas = (wanted) => { painter = wanted ? new Raster() : makePainter(); viewers.forEach((one) => one.draw()); };
  window.signorini = { ...window.signorini, maps: { make, mount, useCanvas, viewers } };
})();
