// A small plot without interaction: a few lines over wavelength.

/** A line of the plot; its name stands at its end. */
export interface Line {
  readonly name: string;
  readonly x: readonly number[];
  readonly values: readonly number[];
  readonly colour: string;
}

const WIDTH = 320;
const HEIGHT = 140;
const LEFT = 36;
const RIGHT = 306;
const TOP = 8;
const BOTTOM = 116;
/** The range of the plot, nm: the visible wavelengths. */
const FROM_NM = 380;
const TO_NM = 780;

/** Returns a tick distance of 1, 2 or 5 times a power of ten that divides a range into two to five parts. */
export function tick(range: number): number {
  const rough = range / 5;
  const power = 10 ** Math.floor(Math.log10(rough));
  const best = [1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10;
  return best * power;
}

export function Sketch({ lines, label }: { lines: readonly Line[]; label: string }) {
  const inside = (nm: number) => nm >= FROM_NM && nm <= TO_NM;
  const values = lines.flatMap((line) => line.values.filter((_, i) => inside(line.x[i] ?? 0)));
  const top = Math.max(...values, 1e-9) * 1.05;
  const x = (nm: number) => LEFT + ((nm - FROM_NM) / (TO_NM - FROM_NM)) * (RIGHT - LEFT);
  const y = (value: number) => BOTTOM - (value / top) * (BOTTOM - TOP);
  const step = tick(top);
  const ticks = Array.from({ length: Math.floor(top / step) + 1 }, (_, i) => i * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step)));
  return (
    <svg class="sketch" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={label}>
      {ticks.map((value) => (
        <g key={value}>
          <line class="grid" x1={LEFT} x2={RIGHT} y1={y(value)} y2={y(value)} />
          <text x={LEFT - 4} y={y(value) + 4} text-anchor="end">
            {value.toFixed(digits)}
          </text>
        </g>
      ))}
      {[400, 500, 600, 700].map((nm) => (
        <text key={nm} x={x(nm)} y={BOTTOM + 14} text-anchor="middle">
          {nm}
          {nm === 700 ? " nm" : ""}
        </text>
      ))}
      {lines.map((line) => {
        const points = line.x.map((nm, i) => [nm, line.values[i] ?? 0] as const).filter(([nm]) => inside(nm));
        const last = points.at(-1);
        return (
          <g key={line.name}>
            <polyline
              points={points.map(([nm, value]) => `${x(nm).toFixed(1)},${y(value).toFixed(1)}`).join(" ")}
              stroke={line.colour}
            />
            {line.name && last && (
              <text x={RIGHT + 4} y={y(last[1]) + 4} style={{ fill: line.colour }}>
                {line.name}
              </text>
            )}
          </g>
        );
      })}
    </svg>
  );
}
