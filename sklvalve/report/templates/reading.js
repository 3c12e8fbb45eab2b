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
  return data.start === null ? `${short(times[at])} ${data.unit}` : stamp(times[at]).slice(0, 19).replace("T", " ");
}

// A time by the recording's own calendar, which is nobody's zone.
function stamp(time) {
  return new Date(data.start + Math.round(1000 * data.seconds * time)).toISOString();
}

const STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400, 172800,
  604800, 1209600, 2592000, 7776000, 31536000];

// Round times of the calendar: clock times, and dates where days are all that is left.
function calendarTicks(low, high, count) {
  const step = STEPS.find((each) => each >= (data.seconds * (high - low)) / count) ?? STEPS[STEPS.length - 1];
  const begin = data.start / 1000 + data.seconds * low, end = data.start / 1000 + data.seconds * high;
  const found = [];
  for (let k = Math.ceil(begin / step); k * step <= end; k++) {
    const words = new Date(1000 * k * step).toISOString();
    const clock = step < 60 ? words.slice(11, 19) : words.slice(11, 16);
    const midnight = words.slice(11, 19) === "00:00:00";
    found.push([(k * step - data.start / 1000) / data.seconds, midnight ? words.slice(5, 10) : clock]);
  }
  return found;
}

function timeTicks(low, high, count) {
  return data.start === null ? ticks(low, high, count) : calendarTicks(low, high, count);
}

// What stands below the axis: its unit, or the dates in view.
function timeLabel(from, to) {
  if (data.start === null) return `${data.label} [${data.unit}]`;
  const [first, last] = [stamp(from).slice(0, 10), stamp(to).slice(0, 10)];
  return first === last ? `${data.label} on ${first}` : `${data.label}, ${first} to ${last}`;
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
