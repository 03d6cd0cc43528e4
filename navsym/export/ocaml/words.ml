(* Statements on matrices of any size: the kind `words` of docs/certificates.md. Sums of words in letters that do not commute. *)

open Text
open Tree
open Goal
open Sized

type letter = { index : int; turned : bool }

(* A letter that was made: its name, its size, and whether it is its own transposed *)
type made = { name : string; high : dimension; wide : dimension; symmetric : bool }

(* Words from one dimension to another, each once, with numbers before them *)
type total = { tall : dimension; broad : dimension; words : (letter list * tree) list }

type value = Whole of tree | Total of total

type state = {
  statement : statement;
  mutable letters : made list; (* the last one first *)
  mutable relations : total list; (* the last one first *)
  mutable inverses : (int * int) list; (* letter -> its inverse *)
  mutable arguments : (total * int) list; (* sums that have a letter of their own *)
  mutable divided : tree list; (* by which the statement divides, or which it takes to have a value *)
}

let find_letter state i = List.nth state.letters (List.length state.letters - 1 - i)
let start_of state l = let m = find_letter state l.index in if l.turned then m.wide else m.high
let end_of state l = let m = find_letter state l.index in if l.turned then m.high else m.wide
let letter state i turned = { index = i; turned = turned && not (find_letter state i).symmetric }
let turn_letter state l = letter state l.index (not l.turned)
let turn_word state w = List.rev_map (turn_letter state) w

(* Sums *)

let vanishes t = Algebra.vanishes t
let normal words = List.filter (fun (_, c) -> not (vanishes c)) words

let add_words a b =
  let add found (w, c) =
    match List.assoc_opt w found with
    | Some d -> (w, Sum [ d; c ]) :: List.remove_assoc w found
    | None -> (w, c) :: found
  in
  List.fold_left add a b

let scaled c total = { total with words = List.map (fun (w, d) -> (w, Prod [ c; d ])) total.words }

let add a b =
  if a.tall <> b.tall || a.broad <> b.broad then refuse "different sizes";
  { a with words = add_words a.words b.words }

let is_null total = normal total.words = []
let differ a b = add a (scaled (Num Q.minus_one) b)
let same a b = a.tall = b.tall && a.broad = b.broad && is_null (differ a b)
let unit_of d = { tall = d; broad = d; words = [ ([], one) ] }
let size_tree = function Any n -> Sym n | Exactly k -> Tree.number k

(* Traces *)

let rec rotations before = function [] -> [] | l :: rest as w -> (w @ List.rev before) :: rotations (l :: before) rest

let trace_symbol state w =
  let all = List.concat_map (rotations []) [ w; turn_word state w ] in
  let list w = List.map (fun l -> (l.index, l.turned)) w in
  let least = List.fold_left (fun best w -> if compare (list w) best < 0 then list w else best) (list (List.hd all)) all in
  let write (i, turned) = string_of_int i ^ if turned then "t" else "" in
  Sym ("trace__" ^ String.concat "_" (List.map write least))

(* The word without its parts between two cuts, and these as numbers *)
let cut state first w =
  let rec go kept inside place numbers = function
    (* inside: the letters since the last cut, if there was one *)
    | [] -> (kept, inside, numbers)
    | l :: rest ->
        let place = ignore place; end_of state l in
        let inside' = match inside with None -> None | Some part -> Some (l :: part) in
        if place = Exactly 1 then
          match inside' with
          | None -> go (l :: kept) (Some []) place numbers rest
          | Some part -> go kept (Some []) place (trace_symbol state (List.rev part) :: numbers) rest
        else (match inside' with
              | None -> go (l :: kept) None place numbers rest
              | Some part -> go kept (Some part) place numbers rest)
  in
  let kept, inside, numbers = go [] (if first = Exactly 1 then Some [] else None) first [] w in
  (List.rev kept @ (match inside with None -> [] | Some part -> List.rev part), numbers)

let with_word state first (w, c) =
  let w, numbers = cut state first w in
  (w, Prod (c :: numbers))

let multiply state a b =
  if a.broad <> b.tall then refuse "@: different sizes";
  let pair (v, c) (w, d) = with_word state a.tall (v @ w, Prod [ c; d ]) in
  let words = List.concat_map (fun x -> List.map (pair x) b.words) a.words in
  if List.length words > 20_000 then refuse "more than 20000 words";
  { tall = a.tall; broad = b.broad; words = add_words [] words }

let turn state a =
  { tall = a.broad; broad = a.tall; words = add_words [] (List.map (fun (w, c) -> with_word state a.broad (turn_word state w, c)) a.words) }

let trace state a =
  if a.tall <> a.broad then refuse "trace: expected a square matrix";
  let of_word (w, c) =
    let rec begin_at_one before = function
      | [] -> None
      | l :: rest as here -> if start_of state l = Exactly 1 then Some (here @ List.rev before) else begin_at_one (l :: before) rest
    in
    if w = [] then Prod [ c; size_tree a.tall ]
    else match begin_at_one [] w with
      | Some turned -> let left, numbers = cut state (Exactly 1) turned in
          if left <> [] then outside "a trace that is not cut"; Prod (c :: numbers)
      | None -> Prod [ c; trace_symbol state w ]
  in
  Sum (zero :: List.map of_word a.words)

let of_letter state i =
  let m = find_letter state i in
  let l = { index = i; turned = false } in
  { tall = m.high; broad = m.wide; words = [ with_word state m.high ([ l ], one) ] }

(* Relations: sums that are 0 *)

let relate state sum =
  let rec go sum =
    let turned = turn state sum in
    if not (List.exists (fun r -> same r sum || same r turned) state.relations) then begin
      state.relations <- sum :: state.relations;
      if not (same sum turned) then state.relations <- turned :: state.relations;
      if sum.tall = sum.broad then
        match List.partition (fun (w, _) -> w = []) (normal sum.words) with
        | [ (_, c) ], [ (w, d) ]
          when vanishes (Sum [ c; d ]) && (vanishes (subtract d one) || vanishes (Sum [ d; one ])) ->
            let rec inside before = function
              | [] -> ()
              | l :: rest ->
                  let place = start_of state l in
                  if before <> [] && place = sum.tall && place <> Exactly 1 then
                    go { sum with words = [ ((l :: rest) @ List.rev before, one); ([], Num Q.minus_one) ] };
                  inside (l :: before) rest
            in
            inside [] w
        | _ -> ()
    end
  in
  go sum

let make state name high wide symmetric =
  state.letters <- { name; high; wide; symmetric } :: state.letters;
  List.length state.letters - 1

let inverse_of state i =
  match List.assoc_opt i state.inverses with
  | Some x -> x
  | None ->
      let m = find_letter state i in
      let x = make state ("inv__" ^ m.name) m.wide m.high m.symmetric in
      state.inverses <- (i, x) :: (x, i) :: state.inverses;
      let a = of_letter state i and b = of_letter state x in
      relate state (differ (multiply state a b) (unit_of m.high));
      relate state (differ (multiply state b a) (unit_of m.high));
      x

let declare state (name, (m : matrix)) =
  let has p = List.mem p m.properties in
  let symmetric = List.exists has [ "symmetric"; "positive"; "nonnegative"; "diagonal" ] in
  let before = state.letters in
  let i = make state name m.rows m.columns symmetric in
  let a = of_letter state i in
  if List.exists has [ "positive"; "invertible"; "orthogonal" ] then ignore (inverse_of state i);
  if has "orthogonal" then begin
    relate state (differ (multiply state a (turn state a)) (unit_of m.rows));
    relate state (differ (multiply state (turn state a) a) (unit_of m.rows))
  end;
  if has "skew" then relate state (add a (turn state a));
  if has "diagonal" then
    let with_diagonal (other : made) =
      match List.assoc_opt other.name state.statement.matrices with
      | Some (o : matrix) when List.mem "diagonal" o.properties && o.rows = m.rows ->
          let k = List.length state.letters - 1 - (let rec place k = function l :: r -> if l == other then k else place (k + 1) r | [] -> 0 in place 0 state.letters) in
          let b = of_letter state k in
          relate state (differ (multiply state a b) (multiply state b a))
      | _ -> ()
    in
    List.iter with_diagonal (List.rev before)

(* Texts *)

let has_trace t = Names.exists (starts_with "trace__") (symbols t)

let rec inverse state a =
  if a.tall <> a.broad then refuse "inv: expected a square matrix";
  match normal a.words with
  | [ ([], c) ] -> state.divided <- c :: state.divided; scaled (Pow (c, Num Q.minus_one)) (unit_of a.tall)
  | [ ([ l ], c) ] ->
      state.divided <- c :: state.divided;
      let x = inverse_of state l.index in
      let b = of_letter state x in
      scaled (Pow (c, Num Q.minus_one)) (if l.turned then turn state b else b)
  | [ (w, c) ] when not (vanishes (subtract c one)) ->
      state.divided <- c :: state.divided;
      scaled (Pow (c, Num Q.minus_one)) (inverse state { a with words = [ (w, one) ] })
  | _ ->
      let i =
        match List.find_opt (fun (sum, _) -> same sum a) state.arguments with
        | Some (_, i) -> i
        | None ->
            let i = make state (Printf.sprintf "arg__%d" (List.length state.arguments + 1)) a.tall a.broad (same a (turn state a)) in
            state.arguments <- (a, i) :: state.arguments;
            relate state (differ (of_letter state i) a);
            i
      in
      of_letter state (inverse_of state i)

let rec evaluate state t =
  let go = evaluate state in
  let s = state.statement in
  let total what t = match go t with Total a -> a | Whole _ -> refuse "%s: expected a matrix" what in
  let whole what t = match go t with Whole x -> x | Total _ -> refuse "%s: expected a number" what in
  let plain what t = let x = whole what t in if has_trace x then refuse "%s of a trace" what; x in
  let number a = if a.tall = Exactly 1 && a.broad = Exactly 1 then
      Whole (Sum (zero :: List.map (fun (w, c) -> if w = [] then c else outside "a number that is a word") a.words)) else Total a in
  match t with
  | Number q -> Whole (Num q)
  | Ratio_of_circle -> Whole Pi
  | Name name ->
      if List.mem_assoc name s.matrices then
        let rec place k = function (m : made) :: r -> if m.name = name then k else place (k - 1) r | [] -> refuse "unknown %s" name in
        Total (of_letter state (place (List.length state.letters - 1) state.letters))
      else if List.mem name s.dimensions || List.mem_assoc name s.box then Whole (Sym name)
      else Value.no_symbols name
  | Plus l -> (
      match List.map go l with
      | Whole x :: rest -> Whole (Sum (x :: List.map (function Whole y -> y | Total _ -> refuse "a number and a matrix") rest))
      | Total a :: rest -> Total (List.fold_left (fun a b -> match b with Total b -> add a b | Whole _ -> refuse "a number and a matrix") a rest)
      | [] -> assert false)
  | Minus t -> ( match go t with Whole x -> Whole (negate x) | Total a -> Total (scaled (Num Q.minus_one) a))
  | Below t ->
      let x = whole "a divisor" t in
      state.divided <- x :: state.divided;
      Whole (Pow (x, Num Q.minus_one))
  | Times l -> (
      let values = List.map go l in
      let x = Prod (one :: List.filter_map (function Whole x -> Some x | Total _ -> None) values) in
      match List.filter_map (function Total a -> Some a | Whole _ -> None) values with
      | [] -> Whole x
      | [ a ] -> Total (scaled x a)
      | _ -> refuse "products of matrices are written with @")
  | Matmul (a, b) -> let a = total "@" a in number (multiply state a (total "@" b))
  | Power (a, b) ->
      let e = plain "an exponent" b in
      let x = whole "a base" a in
      (match !constant e with
      | Some q when is_whole q && Q.sign q > 0 -> ()
      | _ -> if has_trace x then refuse "a power of a trace");
      Whole (Pow (x, e))
  | Turned t | Call ("transpose", [ t ]) -> Total (turn state (total ".T" t))
  | Call ("inv", [ t ]) -> Total (inverse state (total "inv" t))
  | Call ("trace", [ t ]) -> Whole (trace state (total "trace" t))
  | Call ("dot", [ u; v ]) -> let u = total "dot" u in number (multiply state (turn state u) (total "dot" v))
  | Call ("eye", [ n ]) -> number (unit_of (dimension_of s n))
  | Call ("zeros", [ m; n ]) -> let m = dimension_of s m in Total { tall = m; broad = dimension_of s n; words = [] }
  | Call (name, [ t ]) when List.mem name of_one -> Whole (apply name (plain "a function" t))
  | Call (name, _) -> refuse "expression: unknown function %s" name

(* Both sides as one sum of words *)
let as_total = function Total a -> a | Whole x -> { tall = Exactly 1; broad = Exactly 1; words = [ ([], x) ] }

let difference state (left, right) =
  let a = evaluate state left in
  differ (as_total a) (as_total (evaluate state right))

(* Shares *)

let read_word state what text =
  let read part =
    let n = String.length part in
    let name, turned = if n > 2 && String.sub part (n - 2) 2 = ".T" then (String.sub part 0 (n - 2), true) else (part, false) in
    let rec place k = function (m : made) :: r -> if m.name = name then k else place (k - 1) r | [] -> refuse "%s: unknown letter %s" what name in
    let i = place (List.length state.letters - 1) state.letters in
    if turned && (find_letter state i).symmetric then refuse "%s: a letter that is its own transposed" what;
    letter state i turned
  in
  List.map read (List.filter (fun s -> s <> "") (String.split_on_char ' ' text))

let total_of state start stop w =
  let rec check place = function
    | [] -> if place <> stop then refuse "a word of another size"
    | l :: rest -> if start_of state l <> place then refuse "a word of another size" else check (end_of state l) rest
  in
  check start w;
  { tall = start; broad = stop; words = [ with_word state start (w, one) ] }

let side_of state w edge at_start =
  (* the dimension at the other side of a word that is read from an edge *)
  match w with [] -> edge | _ -> if at_start then end_of state (List.nth w (List.length w - 1)) else start_of state (List.hd w)

(* Whether a divisor is seen to differ from 0: by the ranges of its symbols, or because the statement divides by it. *)
let is_apart state t =
  let s = state.statement in
  let ball_of range =
    let edge default = function None -> default | Some t -> Value.number_ball "range" t in
    Ball.between (edge Ball.everything range.low).lo (edge Ball.everything range.high).hi
  in
  let value name =
    if List.mem name s.dimensions then Ball.between Ball.ball_one.lo Plus
    else match List.assoc_opt name s.box with Some r -> ball_of r | None -> Ball.everything
  in
  let is_end t = Option.fold ~none:false ~some:vanishes t in
  let rec apart t =
    List.exists (fun d -> vanishes (subtract d t) || vanishes (Sum [ d; t ])) state.divided
    || match t with
       | Sym name when List.mem_assoc name s.box ->
           let r = List.assoc name s.box in
           r.nonzero || (r.open_low && is_end r.low) || (r.open_high && is_end r.high) || Ball.is_above (ball_of r) || Ball.is_below (ball_of r)
       | Prod l -> List.for_all apart l
       | Pow (b, _) -> apart b
       | _ -> ( match Value.ball Whole value t with x -> not (Ball.has_zero x) | exception Ball.No_value -> false)
  in
  apart t

let check_coefficient state c =
  let known = conditions 0 state.divided in
  let check (relation, t) =
    let is_known = List.mem (relation, t) known || (relation = Unequal && is_apart state t) in
    shown "a divisor of a coefficient may be 0" is_known
  in
  let names = state.statement.dimensions @ List.map fst state.statement.box in
  Names.iter (fun s -> if not (List.mem s names || starts_with "trace__" s) then Value.no_symbols s) (symbols c);
  List.iter check (conditions 0 [ c ])

let read_share state (goal : total) value =
  match get_keys "share" [ "coefficient"; "left"; "right"; "word"; "relation" ] value with
  | [ coefficient; left; right; word; relation ] ->
      let relations = List.rev state.relations in
      let relation = List.nth relations (get_integer "relation" 0 (List.length relations - 1) relation) in
      let c = get_tree "coefficient" coefficient in
      check_coefficient state c;
      let left = read_word state "left" (get_text "left" left) and right = read_word state "right" (get_text "right" right) in
      let start = match left with [] -> relation.tall | l :: _ -> start_of state l in
      let stop = match List.rev right with [] -> relation.broad | l :: _ -> end_of state l in
      let before = total_of state start relation.tall left and after = total_of state relation.broad stop right in
      let whole = multiply state (multiply state before relation) after in
      let part =
        match word with
        | Null -> whole
        | word ->
            let w = read_word state "word" (get_text "word" word) in
            let number = trace state whole in
            scaled number (total_of state goal.tall goal.broad w)
      in
      if part.tall <> goal.tall || part.broad <> goal.broad then refuse "a share of another size";
      scaled c part
  | _ -> assert false

let check value =
  (match value with Text.Object keys when List.mem_assoc "above" keys -> outside "words: an inequality" | _ -> ());
  match get_keys "words" [ "kind"; "statement"; "witness"; "shares" ] value with
  | [ _; statement; witness; shares ] ->
      let statement = Sized.read_statement statement in
      if statement.relation <> "=" then refuse "words: expected an equation";
      let point = read_point statement witness in
      check_hypotheses statement point;
      shown "the statement does not hold at the witness" (holds_at statement point);
      let state = { statement; letters = []; relations = []; inverses = []; arguments = []; divided = [] } in
      List.iter (declare state) statement.matrices;
      List.iter (fun equation -> relate state (difference state equation)) statement.given;
      let goal = difference state (statement.left, statement.right) in
      let part = List.fold_left (fun rest share -> differ rest (read_share state goal share)) goal (get_list "shares" shares) in
      shown "another sum of words" (is_null part)
  | _ -> assert false
