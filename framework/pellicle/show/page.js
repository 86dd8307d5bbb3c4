"use strict";

// Sorting: a click on the head of a column, numbers as numbers; a second click turns it round.
for (const head of document.querySelectorAll("th")) {
  head.firstElementChild.addEventListener("click", () => {
    const body = head.closest("table").tBodies[0];
    const rising = head.getAttribute("aria-sort") !== "ascending";
    const text = (row) => row.cells[head.cellIndex].textContent.replace(/^[<>] /, "");
    const order = (one, other) => {
      const gap = parseFloat(text(one)) - parseFloat(text(other));
      return Number.isNaN(gap) ? text(one).localeCompare(text(other)) : gap;
    };
    for (const other of head.parentNode.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", rising ? "ascending" : "descending");
    const rows = [...body.rows].sort(order);
    body.append(...(rising ? rows : rows.reverse()));
  });
}

// On a narrow page each row is a list, so that long tables begin folded; paper shows all.
const folds = [...document.querySelectorAll("details")];
if (matchMedia("(max-width: 40rem)").matches)
  for (const fold of folds) fold.open &&= fold.querySelectorAll("tbody tr").length <= 3;
addEventListener("beforeprint", () => { for (const fold of folds) fold.open = true; });

const NOTHING = 65535;
const MARGIN = { left: 58, right: 84, top: 26, bottom: 40 };
// A map on paper: half a page wide, in the colours of a page in the light.
const PRINTED = { width: 360, ratio: 3, ink: "#000", blank: "#e9ecee" };
const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const rounded = (value) => String(Number(value.toPrecision(4))).replace("-", "−");

// The values of a field, NaN where there is none: see _pack in maps.py.
async function unpack(packed, count) {
  const stream = new Blob([bytesOf(packed.data)]).stream();
  const inflated = stream.pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(inflated).arrayBuffer());
  const values = new Float32Array(count);
  for (let k = 0, code = 0; k < count; k++) {
    code = (code + (bytes[k] << 8) + bytes[count + k]) & 0xffff;
    const share = code / (NOTHING - 1);
    values[k] = code === NOTHING ? NaN : packed.low + share * (packed.high - packed.low);
  }
  return values;
}

// Round numbers from low to high, at most about `most` of them.
function ticks(low, high, most) {
  if (!(high > low)) return [low];
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => (high - low) / s <= most);
  const numbers = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) numbers.push(n * step);
  return numbers;
}

function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Pictures that show what the chosen frame of the first maps shows.
const followers = [...document.querySelectorAll("figure.follows")].map((figure) => {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const image = figure.querySelector("img"), caption = figure.querySelector("figcaption");
  return (index) => {
    const { source, caption: text, description } = data.pictures[data.frames[index]];
    if (image.src !== source) image.src = source;
    image.alt = description;
    caption.textContent = text;
  };
});

function makeMaps(figure, data) {
  const select = figure.querySelector("select");
  const line = figure.querySelector("input[type=range]");
  const alone = figure.querySelector("input[type=checkbox]");
  const readout = figure.querySelector("output");
  const note = figure.querySelector(".note");
  const canvases = [...figure.querySelectorAll("canvas")];
  const colours = data.fields.map((field) => bytesOf(field.colours));
  const pictures = canvases.map(() => document.createElement("canvas"));
  let frame, values, view, cursor = null, shown = -1, limits = [], printing = false;

  // The area of the map within the canvas, in CSS pixels.
  const extent = (canvas) => {
    const width = printing ? PRINTED.width : canvas.clientWidth;
    const aspect = Math.min(2, Math.max(0.2, frame.size[1] / frame.size[0]));
    return [width, (width - MARGIN.left - MARGIN.right) * aspect + MARGIN.top + MARGIN.bottom];
  };
  const box = (canvas) => {
    const [across, up] = extent(canvas);
    const width = across - MARGIN.left - MARGIN.right, height = up - MARGIN.top - MARGIN.bottom;
    return { width, height, x: MARGIN.left, y: MARGIN.top };
  };
  const whole = () => {
    const [width, height] = frame.size;
    return { x: -width / 2, y: -height / 2, width, height };
  };
  const valueAt = (number, at) => {
    const [nx, ny] = frame.shape;
    const i = Math.floor((at.x + frame.size[0] / 2) / frame.pixel[0]);
    const j = Math.floor((at.y + frame.size[1] / 2) / frame.pixel[1]);
    return i < 0 || j < 0 || i >= nx || j >= ny ? NaN : values[number][i * ny + j];
  };

  async function show(index) {
    const wanted = data.frames[index];
    const count = wanted.shape[0] * wanted.shape[1];
    shown = index;
    const unpacked = await Promise.all(wanted.fields.map((field) => unpack(field, count)));
    if (shown !== index) return; // another frame was chosen meanwhile
    const moved = !frame || frame.size.some((edge, axis) => edge !== wanted.size[axis]);
    frame = wanted;
    values = unpacked;
    if (moved) view = whole();
    select.value = index;
    if (line) line.value = index;
    if (note) note.textContent = wanted.note;
    if (figure.id === "maps") {
      for (const mark of document.querySelectorAll("[data-mark]")) mark.hidden = Number(mark.dataset.mark) !== index;
      for (const picture of followers) picture(index);
    }
    paint();
  }

  // The range of the colours: of this frame, or of the pixels in view.
  function range(number) {
    const [low, high] = rangeOfValues(number);
    const most = Math.max(-low, high);
    return data.fields[number].centred ? [-most, most] : [low, high];
  }

  function rangeOfValues(number) {
    const { low: least, high: most } = frame.fields[number];
    if (!alone.checked) return [least, most];
    const [nx, ny] = frame.shape;
    const cell = (at, axis) => Math.floor((at + frame.size[axis] / 2) / frame.pixel[axis]);
    let low = Infinity, high = -Infinity;
    for (let i = Math.max(0, cell(view.x, 0)); i <= Math.min(nx - 1, cell(view.x + view.width, 0)); i++)
      for (let j = Math.max(0, cell(view.y, 1)); j <= Math.min(ny - 1, cell(view.y + view.height, 1)); j++) {
        const value = values[number][i * ny + j];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    return low <= high ? [low, high] : [least, most];
  }

  // The position of a value in the colour map, from 0 to 1, and the index of its first byte there.
  const shareOf = (number, value, [low, high]) =>
    high > low ? Math.max(0, (value - low) / (high - low)) ** data.fields[number].power : 0;
  const colourAt = (share) => 3 * Math.min(255, Math.floor(share * 256));

  // One pixel for each value; empty pixels are transparent.
  function paint() {
    const [nx, ny] = frame.shape;
    pictures.forEach((picture, number) => {
      limits[number] = range(number);
      picture.width = nx;
      picture.height = ny;
      const image = new ImageData(nx, ny);
      for (let i = 0; i < nx; i++)
        for (let j = 0; j < ny; j++) {
          const value = values[number][i * ny + j];
          if (Number.isNaN(value) || (data.fields[number].blank && value === 0)) continue;
          const from = colourAt(shareOf(number, value, limits[number]));
          const to = 4 * ((ny - 1 - j) * nx + i);
          image.data.set(colours[number].subarray(from, from + 3), to);
          image.data[to + 3] = 255;
        }
      picture.getContext("2d").putImageData(image, 0, 0);
    });
    draw();
  }

  function draw() {
    if (!frame) return;
    const style = getComputedStyle(document.documentElement);
    const { ink, blank, ratio } = printing ? PRINTED : {
      ink: style.getPropertyValue("--ink"),
      blank: style.getPropertyValue("--blank"),
      ratio: window.devicePixelRatio || 1,
    };
    canvases.forEach((canvas, number) => {
      const [across, up] = extent(canvas);
      canvas.style.height = `${up}px`;
      canvas.width = Math.round(across * ratio);
      canvas.height = Math.round(up * ratio);
      const pen = canvas.getContext("2d");
      pen.scale(ratio, ratio);
      pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
      pen.fillStyle = blank;
      const { x, y, width, height } = box(canvas);
      const toX = (at) => x + ((at - view.x) / view.width) * width;
      const toY = (at) => y + height - ((at - view.y) / view.height) * height;
      pen.fillRect(x, y, width, height);
      pen.save();
      pen.beginPath();
      pen.rect(x, y, width, height);
      pen.clip();
      pen.imageSmoothingEnabled = false;
      const [left, low] = [-frame.size[0] / 2, -frame.size[1] / 2];
      const right = left + frame.shape[0] * frame.pixel[0], high = low + frame.shape[1] * frame.pixel[1];
      pen.drawImage(pictures[number], toX(left), toY(high), toX(right) - toX(left), toY(low) - toY(high));
      if (cursor) {
        pen.strokeStyle = "rgb(255 255 255 / 80%)";
        pen.globalCompositeOperation = "difference";
        pen.beginPath();
        pen.moveTo(toX(cursor.x), y);
        pen.lineTo(toX(cursor.x), y + height);
        pen.moveTo(x, toY(cursor.y));
        pen.lineTo(x + width, toY(cursor.y));
        pen.stroke();
      }
      pen.restore();
      axes(pen, { x, y, width, height, toX, toY }, ink);
      bar(pen, number, { x: x + width + 12, y, width: 12, height }, ink);
    });
    tell();
  }

  function axes(pen, { x, y, width, height, toX, toY }, ink) {
    pen.strokeStyle = pen.fillStyle = ink;
    pen.strokeRect(x, y, width, height);
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const at of ticks(view.x, view.x + view.width, Math.max(2, width / 60))) {
      pen.fillRect(toX(at) - 0.5, y + height, 1, 4);
      pen.fillText(rounded(at), toX(at), y + height + 6);
    }
    pen.fillText(`x [${data.unit}]`, x + width / 2, y + height + 23);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const at of ticks(view.y, view.y + view.height, Math.max(2, height / 50))) {
      pen.fillRect(x - 4, toY(at) - 0.5, 4, 1);
      pen.fillText(rounded(at), x - 7, toY(at));
    }
    pen.save();
    pen.translate(10, y + height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(`y [${data.unit}]`, 0, 0);
    pen.restore();
  }

  function bar(pen, number, { x, y, width, height }, ink) {
    const field = data.fields[number], [low, high] = limits[number];
    pen.fillStyle = ink;
    pen.textAlign = "left";
    pen.textBaseline = "alphabetic";
    pen.fillText(field.unit ? `${field.name} [${field.unit}]` : field.name, MARGIN.left, y - 9);
    for (let row = 0; row < height; row++) {
      const from = colourAt(Math.max(0, 1 - (row + 0.5) / height));
      pen.fillStyle = `rgb(${colours[number].subarray(from, from + 3).join(" ")})`;
      pen.fillRect(x, y + row, width, Math.min(1.5, height - row));
    }
    pen.fillStyle = pen.strokeStyle = ink;
    pen.strokeRect(x, y, width, height);
    pen.textBaseline = "middle";
    for (const at of ticks(low, high, Math.max(2, height / 50))) {
      const where = y + height * (1 - shareOf(number, at, limits[number]));
      pen.fillRect(x + width, where - 0.5, 4, 1);
      pen.fillText(rounded(at), x + width + 7, where);
    }
  }

  function tell() {
    if (!cursor) return;
    const parts = data.fields.map((field, number) => {
      const value = valueAt(number, cursor);
      return `${field.name} ${Number.isNaN(value) ? "none" : `${rounded(value)} ${field.unit}`}`;
    });
    readout.value = `x = ${rounded(cursor.x)} ${data.unit}, y = ${rounded(cursor.y)} ${data.unit}: ${parts.join(", ")}`;
  }

  // Show the view `next`, limited to the domain and to a width of four pixels.
  function look(next) {
    const all = whole();
    const least = 4 * Math.min(...frame.pixel.map((edge, axis) => edge / frame.size[axis]));
    const share = Math.min(1, Math.max(least, next.width / all.width));
    const width = share * all.width, height = share * all.height;
    const fit = (at, extent, edge) => Math.max(-edge / 2, Math.min(edge / 2 - extent, at));
    const x = fit(next.x + (next.width - width) * next.at[0], width, all.width);
    const y = fit(next.y + (next.height - height) * next.at[1], height, all.height);
    view = { x, y, width, height };
    if (alone.checked) paint();
    else draw();
  }
  const move = (dx, dy) => look({ ...view, x: view.x + dx, y: view.y + dy, at: [0, 0] });
  const zoom = (factor, at = [0.5, 0.5]) => {
    const width = view.width * factor, height = view.height * factor;
    look({ x: view.x + (view.width - width) * at[0], y: view.y + (view.height - height) * at[1], width, height, at });
  };
  const centre = () => {
    cursor = { x: view.x + view.width / 2, y: view.y + view.height / 2 };
    draw();
  };
  const keys = {
    ArrowLeft: () => move(-view.width / 10, 0),
    ArrowRight: () => move(view.width / 10, 0),
    ArrowDown: () => move(0, -view.height / 10),
    ArrowUp: () => move(0, view.height / 10),
    "+": () => zoom(1 / 1.5),
    "=": () => zoom(1 / 1.5),
    "-": () => zoom(1.5),
    0: () => look({ ...whole(), at: [0, 0] }),
  };

  const named = (number, ending) =>
    `${data.fields[number].name} ${frame.label}`.replace(/[^\p{L}\p{N}.]+/gu, "-") + `.${ending}`;
  const save = {
    // The map as it is seen, on the ground of the page.
    png: (number) => {
      const whole = document.createElement("canvas");
      whole.width = canvases[number].width;
      whole.height = canvases[number].height;
      const pen = whole.getContext("2d");
      pen.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--paper");
      pen.fillRect(0, 0, whole.width, whole.height);
      pen.drawImage(canvases[number], 0, 0);
      whole.toBlob((blob) => download(blob, named(number, "png")));
    },
    // All pixels of the map with the positions of their centres, in SI.
    csv: (number) => {
      const field = data.fields[number], [nx, ny] = frame.shape;
      const lines = [`x [m],y [m],${field.name} [${field.si}]`];
      const at = (k, axis) => ((k + 0.5) * frame.pixel[axis] - frame.size[axis] / 2) / data.per_metre;
      for (let i = 0; i < nx; i++)
        for (let j = 0; j < ny; j++) {
          const value = values[number][i * ny + j];
          const text = Number.isNaN(value) ? "" : (value / field.per_si).toPrecision(6);
          lines.push(`${at(i, 0).toPrecision(6)},${at(j, 1).toPrecision(6)},${text}`);
        }
      download(new Blob([lines.join("\n"), "\n"], { type: "text/csv" }), named(number, "csv"));
    },
  };

  for (const canvas of canvases) {
    // The position of an event as shares of the width and height of the view, from below.
    const share = (event) => {
      const { x, y, width, height } = box(canvas), edge = canvas.getBoundingClientRect();
      return [(event.clientX - edge.left - x) / width, 1 - (event.clientY - edge.top - y) / height];
    };
    const inside = ([x, y]) => x >= 0 && x <= 1 && y >= 0 && y <= 1;
    canvas.addEventListener("wheel", (event) => {
      const at = share(event);
      if (!inside(at)) return;
      event.preventDefault();
      zoom(1.2 ** Math.sign(event.deltaY), at);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const at = share(event), { width, height } = box(canvas);
      if (event.buttons & 1) move((-event.movementX / width) * view.width, (event.movementY / height) * view.height);
      cursor = inside(at) ? { x: view.x + at[0] * view.width, y: view.y + at[1] * view.height } : null;
      draw();
    });
    canvas.addEventListener("pointerleave", () => { cursor = null; draw(); });
    canvas.addEventListener("dblclick", keys[0]);
    canvas.addEventListener("keydown", (event) => {
      if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
      centre();
    });
  }
  for (const button of figure.querySelectorAll("[data-save]")) {
    const number = canvases.indexOf(button.closest(".panel").querySelector("canvas"));
    button.addEventListener("click", () => save[button.dataset.save](number));
  }
  for (const button of figure.querySelectorAll("[data-key]")) button.addEventListener("click", keys[button.dataset.key]);
  select.addEventListener("change", () => show(Number(select.value)));
  line?.addEventListener("input", () => show(Number(line.value)));
  alone.addEventListener("change", paint);
  addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  // Before the pages are counted: a canvas that changes its height while they are made adds an
  // empty page, or loses the last one.
  for (const [name, state] of [["beforeprint", true], ["afterprint", false]])
    addEventListener(name, () => { printing = state; draw(); });
  show(Number(select.value));
  return show;
}

const shows = [];
for (const figure of document.querySelectorAll("figure.maps")) {
  if ("DecompressionStream" in window)
    shows.push(makeMaps(figure, JSON.parse(figure.querySelector("script").textContent)));
  else figure.querySelector("output").value = "This browser is too old to show the maps.";
}
for (const link of document.querySelectorAll("a[data-frame]"))
  link.addEventListener("click", () => shows[0]?.(Number(link.dataset.frame)));
