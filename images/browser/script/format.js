// Numbers and dates as text, by the rules of the program's own output.

const superscripts = '⁰¹²³⁴⁵⁶⁷⁸⁹';

function powerOfTen(exponent) {
  const digits = String(Math.abs(exponent)).replace(/\d/g, (d) => superscripts[d]);
  return '10' + (exponent < 0 ? '⁻' : '') + digits;
}

const trueMinus = (text) => text.replace('-', '−');

// Exponent of the leading digit, after rounding to `digits`.
function magnitude(value, digits = 6) {
  return Number(value.toExponential(digits - 1).split('e')[1]);
}

// A number with `digits` significant digits; with a power of ten outside [1e-3, 1e6).
export function readable(value, digits = 4) {
  if (value === null || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const exponent = magnitude(value, digits);
  if (exponent >= -3 && exponent < 6) {
    return trueMinus(value.toFixed(Math.max(0, digits - 1 - exponent)));
  }
  return trueMinus((value / 10 ** exponent).toFixed(digits - 1)) + '×' + powerOfTen(exponent);
}

// An exact number: six digits without trailing zeros.
function exact(value) {
  if (value === null || !Number.isFinite(value)) return readable(value);
  if (value === 0) return '0';
  const exponent = magnitude(value);
  if (exponent >= -3 && exponent < 6) return trueMinus(String(Number(value.toPrecision(6))));
  const digits = String(Number((value / 10 ** exponent).toFixed(4)));
  return trueMinus(digits) + '×' + powerOfTen(exponent);
}

// "79.112 ± 0.044": two digits of the error determine the digits of the value.
export function estimate(value, error) {
  if (error === null) return readable(value) + ' (undetermined)';
  if (!(error > 0) || value === null) return exact(value);
  const last = magnitude(error, 2) - 1;
  const exponent = magnitude(Math.max(Math.abs(value), error));
  if (exponent >= -3 && exponent < 6 && last > -10) {
    const decimals = Math.max(0, -last);
    return trueMinus(value.toFixed(decimals)) + ' ± ' + error.toFixed(decimals);
  }
  const scale = 10 ** exponent;
  const decimals = Math.max(0, exponent - last);
  return `(${trueMinus((value / scale).toFixed(decimals))} ± ${(error / scale).toFixed(decimals)})×` +
    powerOfTen(exponent);
}

export const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);

// Round numbers within [low, high], at most `most`, and the number of decimals they need. Angles in
// degrees use fractions of a turn. Source: P. Heckbert, "Nice numbers for graph labels", Graphics
// Gems (1990).
export function ticks(low, high, most, unit = '') {
  const raw = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(raw));
  const turns = unit === 'deg' && raw > 10 && raw <= 90 ? [15, 30, 45, 90] : [];
  const step = [...turns, ...[1, 2, 5, 10].map((m) => m * power)].find((s) => s >= raw * (1 - 1e-9));
  const values = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) values.push(i * step);
  return { values, step };
}

// Labels of ticks, with a common power of ten if plain numbers are hard to read.
export function tickLabels(values, step) {
  const largest = Math.max(...values.map(Math.abs), step);
  const exponent = Math.floor(Math.log10(largest) + 1e-9);
  const common = exponent >= -3 && exponent < 5 ? 0 : 3 * Math.floor(exponent / 3);
  const decimals = Math.max(0, common - Math.floor(Math.log10(step) + 1e-9));
  return {
    labels: values.map((v) => trueMinus((v / 10 ** common + 0).toFixed(decimals)).replace(/^−(0(\.0*)?)$/, '$1')),
    power: common === 0 ? '' : '×' + powerOfTen(common),
  };
}
