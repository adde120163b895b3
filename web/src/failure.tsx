// What failed, in the words of the program; where none answers, in those of the page.

import { useState } from "preact/hooks";
import { ApiError } from "./api";
import { Told, type Telling } from "./told";

export type Failure = Telling<"error">;

export const failureOf = (caught: unknown): Failure =>
  ({ error: (caught as Error).message, german: caught instanceof ApiError ? { error: caught.german } : null });

/** `before`: words of the page in front of it. */
export function Problem({ of, before }: { of: Failure | null | undefined; before?: string }) {
  return of ? <p role="alert" class="problem">{before}<Told of={of} what="error" /></p> : null;
}

/** Does what may fail: whether it is being done, and what failed of the last one. */
export function useAttempt() {
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<Failure | null>(null);
  const attempt = async (act: () => Promise<unknown>) => {
    setBusy(true);
    setProblem(null);
    await act().catch((caught) => setProblem(failureOf(caught)));
    setBusy(false);
  };
  return { busy, problem, attempt };
}
