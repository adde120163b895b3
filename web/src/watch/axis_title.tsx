/** "press/cushion_1", which may go on in the next line after the name of the press. */
export function AxisTitle({ of }: { of: string }) {
  return <>{of.split(/(?<=\/)/).map((part, k) => <>{k > 0 && <wbr />}{part}</>)}</>;
}
