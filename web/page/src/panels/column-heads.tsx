// The head of a table of states: a column of names, and columns with explanations.

/** A column's heading, and what it means. */
export interface Head {
  readonly head: string;
  readonly help: string;
}

export function ColumnHeads({ columns }: { columns: readonly Head[] }) {
  return (
    <thead>
      <tr>
        <th scope="col">state</th>
        {columns.map(({ head, help }) => (
          <th scope="col" key={head} title={help}>
            {head}
          </th>
        ))}
      </tr>
    </thead>
  );
}
