// Requests to the program that served the page.

function tokenOf(page: ParentNode): string {
  return page.querySelector<HTMLMetaElement>('meta[name="hydroscope-token"]')?.content ?? "";
}
let token = tokenOf(document);

/** A program that was started again has another token: it stands in its page. */
export async function renewToken(): Promise<void> {
  const page = await fetch("/").then((answer) => answer.text());
  token = tokenOf(new DOMParser().parseFromString(page, "text/html"));
}

/** A failure that the program told in words. */
export class ApiError extends Error {
  constructor(readonly status: number, message: string) { super(message); }
}

async function answer<T>(response: Response): Promise<T> {
  const json = await response.json().catch(() => ({ error: response.statusText }));
  if (!response.ok) throw new ApiError(response.status, json.error ?? response.statusText);
  return json as T;
}

function withQuery(path: string, query: Record<string, string | number>): string {
  const words = new URLSearchParams(Object.entries(query).map(([key, value]) => [key, String(value)]));
  return `/api/v1/${path}${words.size > 0 ? `?${words}` : ""}`;
}

export async function get<T>(path: string, query: Record<string, string | number> = {}): Promise<T> {
  return answer<T>(await fetch(withQuery(path, query)));
}

/** The same; null if there is nothing there (yet). */
export async function find<T>(path: string, query: Record<string, string | number> = {}): Promise<T | null> {
  try {
    return await get<T>(path, query);
  } catch (failure) {
    if (failure instanceof ApiError && failure.status === 404) return null;
    throw failure;
  }
}

export async function post<T = object>(path: string, body: unknown = {}): Promise<T> {
  return answer<T>(await fetch(`/api/v1/${path}`, {
    method: "POST",
    headers: { "X-Hydroscope-Token": token, "Content-Type": "application/json" },
    body: JSON.stringify(body),
  }));
}

export async function upload(path: "logs" | "machine", file: File): Promise<void> {
  await answer(await fetch(withQuery(path, { name: file.name }), {
    method: "POST",
    headers: { "X-Hydroscope-Token": token, "Content-Type": "application/octet-stream" },
    body: file,
  }));
}

/** The stream of events; `lost` while there is no connection. The browser connects again by itself. */
export function listen(heard: (event: Record<string, unknown>) => void, connected: (there: boolean) => void): void {
  const source = new EventSource("/api/v1/events");
  source.onopen = () => connected(true);
  source.onerror = () => connected(false);
  source.onmessage = (message) => {
    try {
      heard(JSON.parse(message.data));
    } catch { /* cut off by a stall: the next session tells all */ }
  };
}
