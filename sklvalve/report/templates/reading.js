// What the page carries of the trends, and what is read from it: rows, ranges, ticks, words.
const data = JSON.parse(document.getElementById("trends").textContent);
const times = new Float32Array(bytes(data.time));
const view = { from: times[0], to: data.end, at: null };

function bytes(packed) {
  return Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0)).buffer;
}

// Values of a course: one a time, or in buckets the lowest and the highest.
function unpack(course) {
  const codes = new Uint16Array(bytes(course.codes));
  const step = (course.high - course.low) / 65534;
  const values = Float64Array.from(codes, (code) => (code === 65535 ? NaN : course.low + step * code));
  return { ...course, values, each: codes.length / times.length };
}

// First row at or behind a time.
function row(time) {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1; else high = middle;
  }
  return low;
}

function nearest(time) {
  const behind = Math.min(row(time), times.length - 1);
  return behind > 0 && time - times[behind - 1] < times[behind] - time ? behind - 1 : behind;
}

function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= rough);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  const places = Math.min(Math.max(0, -Math.floor(Math.log10(step))), 12);
  return found.map((value) => [value, (value + 0).toFixed(places).replace(/^-(?=[0.]*$)/, "")]);
}

function short(value) {
  return String(Number(value.toPrecision(4)));
}

function saidAt(course, at) {
  const low = course.values[course.each * at], high = course.values[course.each * at + course.each - 1];
  if (Number.isNaN(low)) return "gap";
  const words = short(low) === short(high) ? short(low) : `${short(low)} to ${short(high)}`;
  return course.unit === "1" ? words : `${words} ${course.unit}`;
}

function moment(at) {
  return `${short(times[at])} ${data.unit}`;
}

// Lowest and highest value of what is in view, with the row before and the row behind it.
function range(panel, first, last) {
  let low = Infinity, high = -Infinity;
  for (const course of panel) {
    for (let k = course.each * first; k < course.each * (last + 1); k++) {
      const value = course.values[k];
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) return [0, 1];
  const edge = 0.06 * (high - low) || Math.abs(low) * 0.01 || 1;
  return [low - edge, high + edge];
}

// A line through the rows; where a column of the screen holds many, through its lowest and highest.
function line(course, first, last, x, y) {
  let path = "", column = null, low = 0, high = 0, broken = true;
  const flush = () => {
    if (column === null) return;
    path += `${broken ? "M" : "L"}${column},${y(low)}`;
    if (high > low) path += `L${column},${y(high)}`;
    broken = false;
    column = null;
  };
  for (let k = course.each * first; k < course.each * (last + 1); k++) {
    const value = course.values[k];
    if (Number.isNaN(value)) { flush(); broken = true; continue; }
    const here = Math.round(4 * x(times[Math.floor(k / course.each)])) / 4;
    if (here !== column) { flush(); column = here; low = high = value; }
    else { low = Math.min(low, value); high = Math.max(high, value); }
  }
  flush();
  return path;
}
