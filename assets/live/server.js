// The calls to the server: JSON, or a stream of lines of JSON for a trace.

const post = (call, signal) => fetch("call", {
  method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(call), signal,
});

/** Returns the answer to a call. An error of the server is thrown as an `Error` with its place. */
export const ask = async (call, patience = 60000) => {
  const response = await post(call, AbortSignal.timeout(patience));
  if (!response.ok) throw new Error(await response.text());
  const answer = await response.json();
  if (answer.trouble) throw Object.assign(new Error(answer.trouble.message), { trouble: answer.trouble });
  return answer;
};

/** Returns the answer to a call as a file. */
export const fetchFile = async call => {
  const response = await post(call);
  if (!response.ok) throw new Error(await response.text());
  if (response.headers.get("Content-Type") === "application/json") {
    throw new Error((await response.json()).trouble.message);
  }
  return response.blob();
};

/** Passes the messages of a trace to `take`; returns whether the trace has come to its end. */
export const follow = async (call, signal, take) => {
  const response = await post(call, signal);
  if (!response.ok) throw new Error(await response.text());
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let [rest, ended] = ["", false];
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return ended;
    const lines = (rest + value).split("\n");
    rest = lines.pop();
    for (const line of lines.filter(Boolean)) {
      const message = JSON.parse(line);
      ended ||= message.end === true || message.superseded === true;
      take(message);
    }
  }
};
