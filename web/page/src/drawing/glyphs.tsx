// The symbols of sources and viewers.

const SUN = Array.from({ length: 8 }, (_, i) => {
  const [c, s] = [Math.cos((i * Math.PI) / 4), Math.sin((i * Math.PI) / 4)];
  return `M${(9.5 * c).toFixed(1)} ${(9.5 * s).toFixed(1)}L${(13 * c).toFixed(1)} ${(13 * s).toFixed(1)}`;
}).join("");

export function Sun() {
  return (
    <>
      <path class="sun-rays" d={SUN} />
      <circle class="sun" r="6.5" />
    </>
  );
}

export function Eye() {
  return (
    <>
      <path class="eye" d="M-12 0C-7 -8 7 -8 12 0C7 8 -7 8 -12 0Z" />
      <circle class="iris" r="4.2" />
    </>
  );
}
