// What the visitor has open, and how it becomes a link: JSON, deflated, in the fragment of the address. A fragment is not sent
// to any server.

/** A file of the visitor. */
export interface Open {
  name: string;
  text: string;
}

export interface State {
  files: Open[];
  /** The file that is shown. */
  at: number;
  /** The pane that is shown. */
  pane: string;
}

/** The fragment of a link to this state. */
export async function packed(state: State): Promise<string> {
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify(state)));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return `#s=${btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`;
}

/** The state of a fragment; nothing where the fragment has none. Rejects where the link is damaged. */
export async function unpacked(fragment: string): Promise<State | undefined> {
  if (!fragment.startsWith("#s=")) return undefined;
  const text = atob(fragment.slice(3).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = await through(new DecompressionStream("deflate-raw"), Uint8Array.from(text, (c) => c.charCodeAt(0)));
  const state: unknown = JSON.parse(new TextDecoder().decode(bytes));
  if (!isState(state)) throw new Error("the link has no files");
  return state;
}

async function through(stream: CompressionStream | DecompressionStream, bytes: Uint8Array): Promise<Uint8Array> {
  const piped = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(piped).arrayBuffer());
}

function isState(value: unknown): value is State {
  const state = value as State | null;
  return (
    Array.isArray(state?.files) &&
    state.files.length > 0 &&
    state.files.every((file) => typeof file?.name === "string" && typeof file.text === "string") &&
    Number.isInteger(state.at) &&
    state.files[state.at] !== undefined &&
    typeof state.pane === "string"
  );
}
