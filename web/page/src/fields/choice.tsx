// A choice between a few words.

export function Choice({
  id,
  value,
  options,
  change,
  label,
}: {
  id?: string;
  value: string;
  options: readonly string[];
  change: (value: string) => void;
  label?: string;
}) {
  return (
    <select id={id} aria-label={label} value={value} onChange={(event) => change(event.currentTarget.value)}>
      {options.map((option) => (
        <option key={option} value={option}>
          {option}
        </option>
      ))}
    </select>
  );
}
